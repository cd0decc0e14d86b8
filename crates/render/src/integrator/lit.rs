// SPDX-License-Identifier: MIT OR Apache-2.0
//! Points to be lit, side by side: what one light does to sixteen of them at a time, in plain loops over arrays.
//!
//! Each number is worked out by the same operations in the same order as for one point by itself, so the bits do not
//! depend on who is next to whom.

use dioptric_geometry::world::{Bundle, Leave, Rays, Sixteen};
use dioptric_math::wide::Kernel;
use dioptric_math::{DVec3, Spectrum};

use super::point::Point;
use super::whitted::Met;
use crate::light::{Sharp, Towards};
use crate::material::{FAINTEST, HighlightModel, whole};

/// Points in a block.
pub(super) const LANES: usize = Bundle::LANES;

/// A vector or a colour of each of sixteen points.
pub(super) type Vectors = [Sixteen; 3];

const ZERO: Vectors = [[0.0; LANES]; 3];

/// Sixteen points, and what a light does to them. Where their rays start is kept beside them.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// The shading normals, and those of the true surfaces, on the rays' sides.
    normal: Vectors,
    geometric: Vectors,
    /// Towards the viewer.
    viewer: Vectors,
    /// The normal times the direction towards the viewer.
    facing: Sixteen,
    /// What the points reflect of light, and the colours of their highlights.
    diffuse: Vectors,
    gloss: Vectors,
    pub power: Power,
    /// What they show so far.
    pub own: Vectors,
    /// Of the light: what arrives, and the cosine of the angle to it.
    pub arriving: Vectors,
    pub cosine: Sixteen,
    /// What that makes of the diffuse colour if nothing is between.
    pub term: Vectors,
    /// How strong the highlight is.
    pub strength: Sixteen,
    /// What of the light is left by what is between.
    pub visibility: Vectors,
    /// What it adds in the end.
    pub sum: [Vectors; 2],
}

/// What highlights the points of a block have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Power {
    /// None of them.
    None,
    /// All the same of Phong's, with a whole exponent; those that have none not counted.
    Same(u32),
    /// Other ones.
    Mixed,
}

impl Block {
    pub const EMPTY: Self = Self {
        normal: ZERO,
        geometric: ZERO,
        viewer: ZERO,
        facing: [0.0; LANES],
        diffuse: ZERO,
        gloss: ZERO,
        power: Power::None,
        own: ZERO,
        arriving: ZERO,
        cosine: [0.0; LANES],
        term: ZERO,
        strength: [0.0; LANES],
        visibility: ZERO,
        sum: [ZERO; 2],
    };

    /// Puts a point into a lane; lane 0 comes first.
    #[inline(always)]
    pub fn set<I>(&mut self, lane: usize, met: &Met<I>) {
        let (lane, point) = (lane % LANES, &met.point);
        let (normal, viewer) = (point.normal, -point.ray.direction);
        put(&mut self.normal, lane, normal);
        put(&mut self.geometric, lane, point.geometric());
        put(&mut self.viewer, lane, viewer);
        put(&mut self.diffuse, lane, point.finish.diffuse);
        put(&mut self.own, lane, met.own);
        self.facing[lane] = normal.dot(viewer);
        if lane == 0 {
            self.power = Power::None;
        }
        let highlight = &point.finish.highlight;
        put(&mut self.gloss, lane, highlight.map_or(Spectrum::ZERO, |h| h.color));
        if let Some(highlight) = highlight {
            let power = match (highlight.model, whole(highlight.exponent)) {
                (HighlightModel::Phong, Some(n)) => Power::Same(n),
                _ => Power::Mixed,
            };
            self.power = match self.power {
                Power::None => power,
                own if own == power => own,
                _ => Power::Mixed,
            };
        }
    }

    /// Takes over a point of another block; lane 0 comes first.
    fn take(&mut self, lane: usize, other: &Self, from: usize) {
        let pairs = [
            (&mut self.normal, &other.normal),
            (&mut self.geometric, &other.geometric),
            (&mut self.viewer, &other.viewer),
            (&mut self.diffuse, &other.diffuse),
            (&mut self.gloss, &other.gloss),
        ];
        for (own, other) in pairs {
            put(own, lane, get(other, from));
        }
        self.facing[lane % LANES] = other.facing[from % LANES];
        self.power = match self.power {
            _ if lane.is_multiple_of(LANES) => other.power,
            own if own == other.power => own,
            _ => Power::Mixed,
        };
    }
}

/// Sets one vector of sixteen.
#[inline(always)]
pub(super) fn put(of: &mut Vectors, lane: usize, value: DVec3) {
    let lane = lane % LANES;
    (of[0][lane], of[1][lane], of[2][lane]) = (value.x, value.y, value.z);
}

/// One vector of sixteen.
#[inline(always)]
pub(super) fn get(of: &Vectors, lane: usize) -> DVec3 {
    let lane = lane % LANES;
    DVec3::new(of[0][lane], of[1][lane], of[2][lane])
}

/// Products of vectors, in the order in which they are taken one by one.
#[inline(always)]
fn dot(a: &Vectors, b: &Vectors, out: &mut Sixteen) {
    for i in 0..LANES {
        out[i] = a[0][i] * b[0][i] + a[1][i] * b[1][i] + a[2][i] * b[2][i];
    }
}

/// What one sample of a light does to each of sixteen points: a bit for each.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Between {
    /// The points to which it sends something.
    pub asked: u16,
    /// Those that it is in front of, and that reflect something of it.
    pub bright: u16,
    /// Those that it is in front of, and whose diffuse colour reflects nothing of it.
    pub dark: u16,
    /// Those that get something of it.
    pub passed: u16,
    /// Whether [`Block::visibility`] says how much that is; else it is all.
    pub tinted: bool,
    /// Whether the light must be asked by each point alone.
    pub odd: bool,
}

/// What light that arrives at sixteen points does if nothing is between.
pub(super) struct Fall<'a> {
    pub rays: &'a Bundle,
    pub block: &'a mut Block,
    /// What multiplies it: 1 over the light's samples.
    pub share: f64,
    pub between: &'a mut Between,
}

impl Kernel for Fall<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { rays, block, share, between } = self;
        let mut above = [0.0; LANES];
        dot(&block.normal, &rays.direction, &mut block.cosine);
        dot(&block.geometric, &rays.direction, &mut above);
        for axis in 0..3 {
            let (term, arriving) = (&mut block.term[axis], &mut block.arriving[axis]);
            let (diffuse, cosine) = (&block.diffuse[axis], &block.cosine);
            for i in 0..LANES {
                arriving[i] *= share;
                term[i] = diffuse[i] * arriving[i] * cosine[i];
            }
        }
        if let Power::Same(n) = block.power {
            // Phong's: r . v with r = 2 (n . l) n - l, without making r.
            let mut base = [0.0; LANES];
            dot(&rays.direction, &block.viewer, &mut base);
            for (i, base) in base.iter_mut().enumerate() {
                let r = 2.0 * block.cosine[i] * block.facing[i] - *base;
                // As `clamp` does it: NaN stays.
                let r = if r < 0.0 { 0.0 } else { r };
                *base = if r > 1.0 { 1.0 } else { r };
            }
            powers(&base, n, &mut block.strength);
        }
        // A light behind the surface sends nothing, and no ray is cast; NaN is behind. A bent normal (bumps, vertex
        // normals) may see a light that the true surface hides.
        let [r, g, b] = &block.term;
        let (mut front, mut colored) = (0, 0);
        for i in 0..LANES {
            front |= u16::from((block.cosine[i] > 0.0) & (above[i] > 0.0)) << i;
            colored |= u16::from((r[i] != 0.0) | (g[i] != 0.0) | (b[i] != 0.0)) << i;
        }
        front &= between.asked;
        (between.bright, between.dark) = (front & colored, front & !colored);
    }
}

/// Sixteen powers of numbers from 0 to 1; what is too faint is none.
#[inline(always)]
fn powers(of: &Sixteen, mut n: u32, out: &mut Sixteen) {
    let (mut base, mut result) = (*of, [1.0; LANES]);
    while n > 0 {
        if n & 1 == 1 {
            for i in 0..LANES {
                result[i] *= base[i];
            }
        }
        for b in &mut base {
            *b *= *b;
        }
        n >>= 1;
    }
    for i in 0..LANES {
        out[i] = if result[i] < FAINTEST { 0.0 } else { result[i] };
    }
}

/// What a row of points to be lit stands for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// The number of the point that was met.
    pub point: u32,
    /// Where a recorder notes what it is told: the row of the point itself, where it stands for a sample of a light.
    pub told: u32,
}

/// Points to be lit, each where rays to lights start.
#[derive(Clone, Debug, Default)]
pub(super) struct Lit {
    pub rays: Rays,
    pub blocks: Vec<Block>,
    pub rows: Vec<Row>,
}

impl Lit {
    pub fn clear(&mut self) {
        self.rays.clear();
        self.rows.clear();
    }

    /// Adds a point.
    pub fn push<I>(&mut self, met: &Met<I>, of: usize) {
        let at = self.rays.len();
        let Point { ray, surface, hit, outside, arrived, .. } = &met.point;
        let leave = Leave::back(hit.id, *outside, *arrived);
        self.rays.push_from(surface.point, surface.error, ray.time, leave);
        self.block_for(at).set(at, met);
        self.rows.push(Row { point: of as u32, told: at as u32 });
    }

    /// Adds a point once more.
    pub fn push_again(&mut self, other: &Self, row: usize) {
        let at = self.rays.len();
        self.rays.push(&other.rays.bundles()[row / LANES].query(row));
        self.block_for(at).take(at, &other.blocks[row / LANES], row);
        self.rows.push(Row { told: row as u32, ..other.rows[row] });
    }

    fn block_for(&mut self, row: usize) -> &mut Block {
        if row / LANES == self.blocks.len() {
            self.blocks.push(Block::EMPTY);
        }
        &mut self.blocks[row / LANES]
    }

    /// The lanes of a block that are points.
    pub fn lanes(&self, block: usize) -> u16 {
        match self.rows.len().saturating_sub(block * LANES) {
            n @ 0..LANES => (1 << n) - 1,
            _ => u16::MAX,
        }
    }
}

/// The lanes whose bits are set.
pub(super) fn lanes(mut bits: u16) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    })
}

/// What a light without a size sends to all points.
pub(super) struct AllFall<'a> {
    pub lit: &'a mut Lit,
    pub light: Sharp,
    pub between: &'a mut [Between],
}

impl Kernel for AllFall<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { lit, light, between } = self;
        let blocks = lit.rays.bundles_mut().iter_mut().zip(&mut lit.blocks);
        for ((rays, block), between) in blocks.zip(between) {
            between.odd = Towards { light, rays, arriving: &mut block.arriving }.run();
            Fall { rays, block, share: 1.0, between }.run();
        }
    }
}

/// Adds to all points what is left of the light, now that it is known what is between.
pub(super) struct AllAdd<'a> {
    pub lit: &'a mut Lit,
    pub between: &'a [Between],
    /// Whether this is all of the light, which the points show then; else it is only put into [`Block::sum`].
    pub whole: bool,
}

impl Kernel for AllAdd<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for (block, between) in self.lit.blocks.iter_mut().zip(self.between) {
            let mut passed = [false; LANES];
            for (i, passed) in passed.iter_mut().enumerate() {
                *passed = between.passed & 1 << i != 0;
            }
            if !between.tinted {
                block.visibility = [[1.0; LANES]; 3];
            }
            for axis in 0..3 {
                let (visibility, [diffuse, highlight]) = (&block.visibility[axis], &mut block.sum);
                let (diffuse, highlight) = (&mut diffuse[axis], &mut highlight[axis]);
                let term = &block.term[axis];
                for i in 0..LANES {
                    diffuse[i] = if passed[i] { term[i] * visibility[i] } else { 0.0 };
                }
                if block.power == Power::None {
                    *highlight = [0.0; LANES];
                } else {
                    let (gloss, arriving) = (&block.gloss[axis], &block.arriving[axis]);
                    for i in 0..LANES {
                        let shine = gloss[i] * arriving[i] * block.strength[i] * visibility[i];
                        highlight[i] = if passed[i] { shine } else { 0.0 };
                    }
                }
                if self.whole {
                    for i in 0..LANES {
                        block.own[axis][i] += diffuse[i] + highlight[i];
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Highlight;
    use dioptric_math::normalize;
    use dioptric_math::random::Random;
    use dioptric_math::wide::wide;

    /// What sixteen at once get of a light is to the last bit what the formulas say for one.
    #[test]
    fn sixteen_get_what_one_gets() {
        let mut random = Random::new(11);
        for exponent in [0, 1, 2, 7, 60, 4096] {
            let mut vector =
                |size: f64| DVec3::from_array([(); 3].map(|()| random.uniform(-size, size)));
            let mut unit = || normalize(vector(1.0)).unwrap_or(DVec3::X);
            let (mut rays, mut block) = (Bundle::EMPTY, Block::EMPTY);
            let mut points = Vec::new();
            for lane in 0..LANES {
                let (normal, viewer, to_light, color) = (unit(), unit(), unit(), unit());
                let geometric = if lane % 3 == 0 { unit() } else { normal };
                put(&mut rays.direction, lane, to_light);
                put(&mut block.normal, lane, normal);
                put(&mut block.geometric, lane, geometric);
                put(&mut block.viewer, lane, viewer);
                put(&mut block.diffuse, lane, if lane == 5 { DVec3::ZERO } else { color });
                put(&mut block.gloss, lane, color);
                put(&mut block.arriving, lane, geometric);
                block.facing[lane] = normal.dot(viewer);
                points.push((normal, geometric, viewer, to_light, color));
            }
            block.power = Power::Same(exponent);
            let mut between = Between { asked: !8, ..Between::default() };
            wide(Fall { rays: &rays, block: &mut block, share: 0.3, between: &mut between });
            let mut expected = (0, 0);
            for (lane, &(normal, geometric, viewer, to_light, color)) in points.iter().enumerate() {
                let arriving = geometric * 0.3;
                let term = get(&block.diffuse, lane) * arriving * normal.dot(to_light);
                assert_eq!((get(&block.arriving, lane), get(&block.term, lane)), (arriving, term));
                let model = HighlightModel::Phong;
                let highlight =
                    Highlight { model, color, exponent: f64::from(exponent), image: false };
                let strength = highlight.strength(normal, to_light, viewer);
                assert_eq!(block.strength[lane].to_bits(), strength.to_bits(), "{exponent}");
                let front = normal.dot(to_light) > 0.0 && geometric.dot(to_light) > 0.0;
                let bits = if lane == 5 { &mut expected.1 } else { &mut expected.0 };
                *bits |= u16::from(front && lane != 3) << lane;
            }
            assert_eq!((between.bright, between.dark), expected);
        }
    }
}
