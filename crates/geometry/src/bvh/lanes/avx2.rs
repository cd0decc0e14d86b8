// SPDX-License-Identifier: MIT OR Apache-2.0
//! Eight boxes or triangles with AVX2 and FMA.

use std::arch::x86_64::{
    __m256, __m256i, _CMP_GE_OQ, _CMP_GT_OQ, _CMP_LE_OQ, _CMP_NGT_UQ, _CMP_NLT_UQ, _mm256_add_ps,
    _mm256_and_ps, _mm256_andnot_ps, _mm256_castps_si256, _mm256_castsi256_ps, _mm256_cmp_ps,
    _mm256_cmpgt_epi32, _mm256_div_ps, _mm256_fmadd_ps, _mm256_fmsub_ps, _mm256_fnmadd_ps,
    _mm256_load_ps, _mm256_max_epi32, _mm256_max_ps, _mm256_min_epi32, _mm256_min_ps,
    _mm256_movemask_ps, _mm256_mul_ps, _mm256_or_ps, _mm256_set1_ps, _mm256_setzero_ps,
    _mm256_setzero_si256, _mm256_storeu_ps, _mm256_sub_ps, _mm256_xor_ps,
};

use super::ball_lanes::{Apart, Entered, apart, entered};
use super::{Aim, BallRay, Balls, BoxRay, Entries, Node, Packet, Sight, Test, WIDTH, eight};

pub(crate) struct Avx2;

/// Bytes of a plane of all boxes.
const PLANE: usize = 32;

/// A ray, a register for each number.
#[derive(Clone, Copy)]
pub(crate) struct Spread {
    near: [__m256; 3],
    far: [__m256; 3],
    inverse: [__m256; 3],
    /// Where the first node's near planes are, and its far ones.
    first: [*const u8; 3],
    last: [*const u8; 3],
}

/// The distances to the near and the far planes of a node, the latter at most the limit.
///
/// # Safety
/// The processor has AVX2 and FMA, and the ray was spread for nodes of which there are more than `index`.
#[inline(always)]
pub(super) unsafe fn slabs(index: usize, ray: &Spread, limit: f32) -> (__m256i, __m256i) {
    let node = index * size_of::<Node>();
    // SAFETY: `first` and `last` are planes of the first node. The caller answers for the index and the instruction set.
    unsafe {
        let Spread { near, far, inverse, first, last } = ray;
        let x = slab(node, first[0], inverse[0], near[0]);
        let y = slab(node, first[1], inverse[1], near[1]);
        let z = slab(node, first[2], inverse[2], near[2]);
        // As whole numbers, which is faster: those of positive numbers are in the same order, and all of negative ones
        // are less.
        let z = _mm256_max_epi32(z, _mm256_setzero_si256());
        let entry = _mm256_max_epi32(_mm256_max_epi32(x, y), z);
        let x = slab(node, last[0], inverse[0], far[0]);
        let y = slab(node, last[1], inverse[1], far[1]);
        let z = slab(node, last[2], inverse[2], far[2]);
        let z = _mm256_min_epi32(z, _mm256_castps_si256(_mm256_set1_ps(limit)));
        (entry, _mm256_min_epi32(_mm256_min_epi32(x, y), z))
    }
}

/// # Safety
/// The processor has AVX2 and FMA.
#[inline(always)]
pub(super) unsafe fn spread(ray: &BoxRay, nodes: &[Node]) -> Spread {
    let start = nodes.as_ptr().cast::<u8>();
    // SAFETY: the caller answers for the instruction set.
    unsafe {
        let [x, y, z] = ray.negative;
        let first = [PLANE * (x & 1), PLANE * (2 | y & 1), PLANE * (4 | z & 1)];
        Spread {
            near: all(ray.near),
            far: all(ray.far),
            inverse: all(ray.inverse),
            first: [
                start.wrapping_add(first[0]),
                start.wrapping_add(first[1]),
                start.wrapping_add(first[2]),
            ],
            last: [
                start.wrapping_add(first[0] ^ PLANE),
                start.wrapping_add(first[1] ^ PLANE),
                start.wrapping_add(first[2] ^ PLANE),
            ],
        }
    }
}

impl Test for Avx2 {
    type Spread = Spread;
    type Eight = eight::Register;

    #[inline(always)]
    unsafe fn spread(ray: &BoxRay, nodes: &[Node]) -> Spread {
        // SAFETY: the caller answers for the instruction set.
        unsafe { spread(ray, nodes) }
    }

    #[inline(always)]
    unsafe fn enter(_: &[Node], index: usize, ray: &Spread, limit: f32) -> (Entries, u32) {
        // SAFETY: the caller answers for the instruction set; the array has the size of a register.
        unsafe {
            let (near, far) = slabs(index, ray, limit);
            let missed = _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpgt_epi32(near, far)));
            let mut entries = [0.0; WIDTH];
            _mm256_storeu_ps(entries.as_mut_ptr(), _mm256_castsi256_ps(near));
            (entries, missed as u32 ^ 255)
        }
    }

    #[inline(always)]
    unsafe fn triangles(packet: &Packet, aim: &Aim, margin: f32, depths: [f32; 2]) -> Sight {
        // SAFETY: the caller answers for the instruction set.
        unsafe {
            let seen = see(packet, aim);
            let Ranges { least, most, low, high } = seen.ranges();
            let positive = _mm256_cmp_ps::<_CMP_GE_OQ>(least, _mm256_set1_ps(-margin));
            let negative = _mm256_cmp_ps::<_CMP_LE_OQ>(most, _mm256_set1_ps(margin));
            let starts = _mm256_cmp_ps::<_CMP_LE_OQ>(low, _mm256_set1_ps(depths[0]));
            let ends = _mm256_cmp_ps::<_CMP_GE_OQ>(high, _mm256_set1_ps(depths[1]));
            let within = _mm256_or_ps(positive, negative);
            let kept =
                _mm256_movemask_ps(_mm256_and_ps(within, _mm256_and_ps(starts, ends))) as u32;
            let mut sight = Sight::unknown(0);
            if kept == 0 {
                return sight;
            }
            let closer = seen.closer(aim, low, high);
            let Closer { margin, depth, slack, .. } = closer;
            let minus = _mm256_sub_ps(_mm256_setzero_ps(), margin);
            let positive = _mm256_cmp_ps::<_CMP_GE_OQ>(least, minus);
            let negative = _mm256_cmp_ps::<_CMP_LE_OQ>(most, margin);
            let minus = _mm256_sub_ps(_mm256_setzero_ps(), slack);
            // Not `>=`: NaN is no reason to reject.
            let ahead = _mm256_cmp_ps::<_CMP_NLT_UQ>(depth, minus);
            let behind = _mm256_cmp_ps::<_CMP_NGT_UQ>(depth, slack);
            let within =
                _mm256_or_ps(_mm256_and_ps(positive, ahead), _mm256_and_ps(negative, behind));
            sight.kept = kept & _mm256_movemask_ps(within) as u32;
            let passed = closer.passed(low, high);
            _mm256_storeu_ps(sight.from.as_mut_ptr(), passed.from);
            _mm256_storeu_ps(sight.to.as_mut_ptr(), passed.to);
            let (twice, minus) = (passed.twice, _mm256_sub_ps(_mm256_setzero_ps(), passed.twice));
            let within = _mm256_or_ps(
                _mm256_cmp_ps::<_CMP_GE_OQ>(least, twice),
                _mm256_cmp_ps::<_CMP_LE_OQ>(most, minus),
            );
            let ahead = _mm256_cmp_ps::<_CMP_GT_OQ>(passed.from, _mm256_set1_ps(aim.certain));
            sight.sure = sight.kept & _mm256_movemask_ps(_mm256_and_ps(within, ahead)) as u32;
            sight
        }
    }

    #[inline(always)]
    unsafe fn balls(balls: &Balls, ray: &BallRay, limit: f32) -> Sight {
        // SAFETY: the caller answers for the instruction set.
        unsafe {
            let apart = apart(balls, ray);
            let Apart { along, square, room } = apart;
            let near = _mm256_cmp_ps::<_CMP_LE_OQ>(square, _mm256_mul_ps(room, room));
            let ends = _mm256_cmp_ps::<_CMP_GE_OQ>(_mm256_add_ps(along, room), _mm256_setzero_ps());
            let kept = _mm256_movemask_ps(_mm256_and_ps(near, ends)) as u32;
            let mut sight = Sight::unknown(0);
            if kept == 0 {
                return sight;
            }
            let Entered { from, to, chord } = entered(&apart, balls, ray);
            _mm256_storeu_ps(sight.from.as_mut_ptr(), from);
            _mm256_storeu_ps(sight.to.as_mut_ptr(), to);
            let before = _mm256_cmp_ps::<_CMP_LE_OQ>(from, _mm256_set1_ps(limit));
            sight.kept = kept & _mm256_movemask_ps(before) as u32;
            let ahead = _mm256_cmp_ps::<_CMP_GT_OQ>(from, _mm256_set1_ps(ray.slack));
            let inside = _mm256_cmp_ps::<_CMP_GT_OQ>(chord, _mm256_setzero_ps());
            sight.sure = sight.kept & _mm256_movemask_ps(_mm256_and_ps(ahead, inside)) as u32;
            sight
        }
    }
}

/// The corners of triangles as a line sees them, and the edge functions.
pub(super) struct Seen {
    corners: [[__m256; 3]; 3],
    edges: [__m256; 3],
}

/// The least and the greatest of the edge functions, and of the depths of the corners.
pub(super) struct Ranges {
    pub least: __m256,
    pub most: __m256,
    pub low: __m256,
    pub high: __m256,
}

/// The second look, with margins for each triangle.
pub(super) struct Closer {
    /// What an edge function may be off by.
    pub margin: __m256,
    /// The depth of the passage times the sum of the edge functions; negative where the line goes against the
    /// axis.
    pub depth: __m256,
    /// What that may be off by.
    pub slack: __m256,
    /// What a sheared coordinate may be off by.
    error: __m256,
    /// The sum of the edge functions.
    total: __m256,
}

/// Where triangles are passed, if they are for certain.
pub(super) struct Passed {
    pub from: __m256,
    pub to: __m256,
    /// How large the edge functions must be.
    pub twice: __m256,
}

impl Closer {
    /// # Safety
    /// The processor has AVX2 and FMA.
    #[inline(always)]
    pub(super) unsafe fn passed(&self, low: __m256, high: __m256) -> Passed {
        // SAFETY: the caller answers for the instruction set.
        unsafe {
            let inverse = _mm256_div_ps(_mm256_set1_ps(1.0), self.total);
            let range = _mm256_mul_ps(_mm256_set1_ps(Aim::RANGES), _mm256_sub_ps(high, low));
            let error = _mm256_mul_ps(_mm256_set1_ps(Aim::ERRORS), self.error);
            let off = _mm256_fmadd_ps(_mm256_mul_ps(self.margin, range), abs(inverse), error);
            Passed {
                from: _mm256_fmsub_ps(self.depth, inverse, off),
                to: _mm256_fmadd_ps(self.depth, inverse, off),
                twice: _mm256_add_ps(self.margin, self.margin),
            }
        }
    }
}

/// # Safety
/// The processor has AVX2 and FMA.
#[inline(always)]
pub(super) unsafe fn see(packet: &Packet, aim: &Aim) -> Seen {
    // SAFETY: the caller answers for the instruction set.
    unsafe {
        let a = corner(&packet.corners[0], aim);
        let b = corner(&packet.corners[1], aim);
        let c = corner(&packet.corners[2], aim);
        Seen { corners: [a, b, c], edges: [edge(c, b), edge(a, c), edge(b, a)] }
    }
}

impl Seen {
    /// # Safety
    /// The processor has AVX2 and FMA.
    #[inline(always)]
    pub(super) unsafe fn ranges(&self) -> Ranges {
        let ([u, v, w], [a, b, c]) = (self.edges, self.corners);
        // SAFETY: the caller answers for the instruction set.
        unsafe {
            Ranges {
                least: _mm256_min_ps(_mm256_min_ps(u, v), w),
                most: _mm256_max_ps(_mm256_max_ps(u, v), w),
                low: _mm256_min_ps(_mm256_min_ps(a[2], b[2]), c[2]),
                high: _mm256_max_ps(_mm256_max_ps(a[2], b[2]), c[2]),
            }
        }
    }

    /// # Safety
    /// The processor has AVX2 and FMA.
    #[inline(always)]
    pub(super) unsafe fn closer(&self, aim: &Aim, low: __m256, high: __m256) -> Closer {
        let ([u, v, w], [a, b, c]) = (self.edges, self.corners);
        // SAFETY: the caller answers for the instruction set.
        unsafe {
            let across = _mm256_max_ps(
                _mm256_max_ps(largest(a[0], a[1]), largest(b[0], b[1])),
                largest(c[0], c[1]),
            );
            let along = largest(low, high);
            let error = _mm256_fmadd_ps(
                _mm256_set1_ps(Aim::ACROSS),
                across,
                _mm256_fmadd_ps(_mm256_set1_ps(Aim::ALONG), along, _mm256_set1_ps(aim.error)),
            );
            let margin = _mm256_mul_ps(
                _mm256_mul_ps(_mm256_set1_ps(Aim::EDGES), error),
                _mm256_add_ps(across, error),
            );
            let margin = _mm256_add_ps(margin, _mm256_set1_ps(f32::MIN_POSITIVE));
            let depth = _mm256_fmadd_ps(u, a[2], _mm256_fmadd_ps(v, b[2], _mm256_mul_ps(w, c[2])));
            let sum = _mm256_add_ps(_mm256_add_ps(abs(u), abs(v)), abs(w));
            let slack = _mm256_fmadd_ps(
                _mm256_mul_ps(_mm256_set1_ps(Aim::DEPTHS), margin),
                along,
                _mm256_fmadd_ps(sum, error, _mm256_set1_ps(f32::MIN_POSITIVE)),
            );
            let sign = _mm256_set1_ps(if aim.forward { 0.0 } else { -0.0 });
            let total = _mm256_add_ps(_mm256_add_ps(u, v), w);
            Closer { margin, depth: _mm256_xor_ps(depth, sign), slack, error, total }
        }
    }
}

// No closures above: they would be compiled without the instruction set, and its instructions be calls.

/// # Safety
/// The processor has AVX2 and FMA.
#[inline(always)]
unsafe fn abs(x: __m256) -> __m256 {
    // SAFETY: the caller answers for the instruction set.
    unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), x) }
}

/// # Safety
/// The processor has AVX2 and FMA.
#[inline(always)]
unsafe fn largest(x: __m256, y: __m256) -> __m256 {
    // SAFETY: the caller answers for the instruction set.
    unsafe { _mm256_max_ps(abs(x), abs(y)) }
}

/// # Safety
/// The processor has AVX2 and FMA.
#[inline(always)]
unsafe fn edge(p: [__m256; 3], q: [__m256; 3]) -> __m256 {
    // SAFETY: the caller answers for the instruction set.
    unsafe { _mm256_fmsub_ps(p[0], q[1], _mm256_mul_ps(p[1], q[0])) }
}

/// A corner of the triangles as the line sees it.
///
/// # Safety
/// The processor has AVX2 and FMA; `rows` are a packet's.
#[inline(always)]
unsafe fn corner(rows: &[[f32; WIDTH]; 3], aim: &Aim) -> [__m256; 3] {
    // SAFETY: the caller answers for the instruction set.
    unsafe {
        let depth = offset(rows, aim, 2);
        let x = _mm256_fnmadd_ps(_mm256_set1_ps(aim.slope[0]), depth, offset(rows, aim, 0));
        let y = _mm256_fnmadd_ps(_mm256_set1_ps(aim.slope[1]), depth, offset(rows, aim, 1));
        [x, y, depth]
    }
}

/// # Safety
/// The processor has AVX2 and FMA; `rows` are a packet's.
#[inline(always)]
unsafe fn offset(rows: &[[f32; WIDTH]; 3], aim: &Aim, axis: usize) -> __m256 {
    // SAFETY: `axes` are 0, 1 and 2 in some order; packets are aligned to 64 bytes and a row of numbers has
    // 32. The caller answers for the instruction set.
    unsafe {
        let row = rows.get_unchecked(aim.axes[axis]);
        _mm256_sub_ps(_mm256_load_ps(row.as_ptr()), _mm256_set1_ps(aim.origin[axis]))
    }
}

/// Distances to planes of all boxes of a node: how far it is from the first one, and where that has these planes.
///
/// # Safety
/// The processor has AVX2 and FMA; there are such planes.
#[inline(always)]
unsafe fn slab(node: usize, plane: *const u8, inverse: __m256, origin: __m256) -> __m256i {
    // SAFETY: the caller answers for the planes and the instruction set; nodes are aligned to 64 bytes and a
    // plane has 32.
    unsafe {
        let planes = _mm256_load_ps(plane.add(node).cast());
        _mm256_castps_si256(_mm256_fmsub_ps(planes, inverse, origin))
    }
}

/// # Safety
/// The processor has AVX2 and FMA.
#[inline(always)]
unsafe fn all(x: [f32; 3]) -> [__m256; 3] {
    // SAFETY: the caller answers for the instruction set.
    unsafe { [_mm256_set1_ps(x[0]), _mm256_set1_ps(x[1]), _mm256_set1_ps(x[2])] }
}
