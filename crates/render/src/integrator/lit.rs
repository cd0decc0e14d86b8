// SPDX-License-Identifier: MIT OR Apache-2.0
//! Points to be lit, side by side: what one light does to sixteen of them at a time, in plain loops over arrays.
//!
//! Each number is worked out by the same operations in the same order as for one point by itself, so the bits do not
//! depend on who is next to whom.

use dioptric_geometry::world::{Bundle, Sixteen};
use dioptric_math::unit_powers;
use dioptric_math::wide::Kernel;
use dioptric_math::{DVec3, Spectrum};

use crate::lanes::{LANES, Vectors, ZERO, get, put};
use crate::light::{Sharp, Towards};
use crate::material::{FAINTEST, Finish, Highlight, HighlightModel, whole};

/// Sixteen points, and what a light does to them. Where their rays start is kept beside them.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// The shading normals, and those of the true surfaces, on the rays' sides.
    pub normal: Vectors,
    pub geometric: Vectors,
    /// Towards the viewer.
    pub viewer: Vectors,
    /// The normal times the direction towards the viewer.
    pub facing: Sixteen,
    /// What the points reflect of light, and the colours of their highlights.
    diffuse: Vectors,
    gloss: Vectors,
    /// The highlights' exponents, where [`Self::power`] says so.
    exponent: Sixteen,
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
    /// Phong's, with exponents above 1 that are not whole.
    Real,
    /// Other ones.
    Mixed,
}

impl Power {
    fn of(highlight: Option<&Highlight>) -> Self {
        let Some(Highlight { model, exponent, .. }) = highlight else { return Self::None };
        match (model, whole(*exponent)) {
            (HighlightModel::Phong, Some(n)) => Self::Same(n),
            (HighlightModel::Phong, None) if (1.0..=1e9).contains(exponent) => Self::Real,
            _ => Self::Mixed,
        }
    }

    /// Of these and those.
    fn and(self, other: Self) -> Self {
        match (self, other) {
            (own, Self::None) => own,
            (Self::None, other) => other,
            (own, other) if own == other => own,
            _ => Self::Mixed,
        }
    }
}

impl Block {
    pub const EMPTY: Self = Self {
        normal: ZERO,
        geometric: ZERO,
        viewer: ZERO,
        facing: [0.0; LANES],
        diffuse: ZERO,
        gloss: ZERO,
        exponent: [1.0; LANES],
        power: Power::None,
        own: ZERO,
        arriving: ZERO,
        cosine: [0.0; LANES],
        term: ZERO,
        strength: [0.0; LANES],
        visibility: ZERO,
        sum: [ZERO; 2],
    };

    /// Puts what a material answers into a lane, with what the point shows before any light.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, finish: &Finish, own: Spectrum) {
        let highlight = finish.highlight.as_ref();
        put(&mut self.diffuse, lane, finish.diffuse);
        put(&mut self.own, lane, own);
        put(&mut self.gloss, lane, highlight.map_or(Spectrum::ZERO, |h| h.color));
        self.exponent[lane % LANES] = highlight.map_or(1.0, |h| h.exponent);
        self.power = self.power.and(Power::of(highlight));
    }

    /// The same for all lanes.
    #[inline(always)]
    pub fn set_all(&mut self, finish: &Finish, own: Spectrum) {
        let highlight = finish.highlight.as_ref();
        let gloss = highlight.map_or(Spectrum::ZERO, |h| h.color);
        let pairs =
            [(&mut self.diffuse, finish.diffuse), (&mut self.own, own), (&mut self.gloss, gloss)];
        for (all, value) in pairs {
            for (all, value) in all.iter_mut().zip(value.to_array()) {
                *all = [value; LANES];
            }
        }
        self.exponent = [highlight.map_or(1.0, |h| h.exponent); LANES];
        self.power = Power::of(highlight);
    }

    /// The shading normal of a point.
    #[inline(always)]
    pub fn normal(&self, lane: usize) -> DVec3 {
        get(&self.normal, lane)
    }

    /// Turns the shading normal of a point elsewhere.
    pub fn turn(&mut self, lane: usize, normal: DVec3) {
        put(&mut self.normal, lane, normal);
        self.facing[lane % LANES] = normal.dot(get(&self.viewer, lane));
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
        self.exponent[lane % LANES] = other.exponent[from % LANES];
        let before = if lane.is_multiple_of(LANES) { Power::None } else { self.power };
        self.power = before.and(other.power);
    }
}

/// Products of vectors, in the order in which they are taken one by one.
#[inline(always)]
pub(super) fn dot(a: &Vectors, b: &Vectors, out: &mut Sixteen) {
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

/// Works out how strong Phong's highlights are.
#[inline(always)]
fn strengths(rays: &Bundle, block: &mut Block) {
    // r . v with r = 2 (n . l) n - l, without making r.
    let mut base = [0.0; LANES];
    dot(&rays.direction, &block.viewer, &mut base);
    for (i, base) in base.iter_mut().enumerate() {
        let r = 2.0 * block.cosine[i] * block.facing[i] - *base;
        // As `clamp` does it: NaN stays.
        let r = if r < 0.0 { 0.0 } else { r };
        *base = if r > 1.0 { 1.0 } else { r };
    }
    match block.power {
        Power::Same(n) => powers(&base, n, &mut block.strength),
        _ => unit_powers(&base, &block.exponent, &mut block.strength),
    }
    // What is too faint is none.
    for strength in &mut block.strength {
        *strength = if *strength < FAINTEST { 0.0 } else { *strength };
    }
}

/// Sixteen powers.
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
    *out = result;
}

/// What a row of points to be lit stands for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// The number of the point that was met.
    pub point: u32,
    /// Where a recorder notes what it is told: the row of the point itself, where it stands for a sample of a light.
    pub told: u32,
}

/// Points to be lit, sixteen by sixteen.
#[derive(Clone, Debug, Default)]
pub(super) struct Lit {
    /// Where rays to lights start, and, light by light, where they go.
    rays: Vec<Bundle>,
    blocks: Vec<Block>,
    /// The lanes of each block that are points to be lit.
    live: Vec<u16>,
    /// What the lanes stand for, where they are samples of a light; else each is the point of the same number.
    rows: Vec<Row>,
}

/// The parts of [`Lit`] that are in use.
pub(super) struct Parts<'a> {
    pub rays: &'a mut [Bundle],
    pub blocks: &'a mut [Block],
    pub live: &'a mut [u16],
}

impl Lit {
    /// Makes room for so many blocks of points, none of which is to be lit yet.
    pub fn begin(&mut self, blocks: usize) {
        self.rows.clear();
        self.live.clear();
        self.live.resize(blocks, 0);
        if self.blocks.len() < blocks {
            self.rays.resize(blocks, Bundle::EMPTY);
            self.blocks.resize(blocks, Block::EMPTY);
        }
    }

    /// Whether there is nothing to be lit.
    pub fn is_dark(&self) -> bool {
        self.live.iter().all(|live| *live == 0)
    }

    /// How many blocks there are.
    pub const fn len(&self) -> usize {
        self.live.len()
    }

    /// All blocks.
    #[inline(always)]
    pub fn parts(&mut self) -> Parts<'_> {
        let count = self.live.len();
        let (rays, blocks) = (&mut self.rays[..count], &mut self.blocks[..count]);
        Parts { rays, blocks, live: &mut self.live }
    }

    #[inline(always)]
    pub fn rays(&self, block: usize) -> &Bundle {
        &self.rays[block]
    }

    /// All that rays to a light need.
    pub fn all_rays(&self) -> &[Bundle] {
        &self.rays[..self.live.len()]
    }

    #[inline(always)]
    pub fn block(&self, block: usize) -> &Block {
        &self.blocks[block]
    }

    #[inline(always)]
    pub fn block_mut(&mut self, block: usize) -> &mut Block {
        &mut self.blocks[block]
    }

    /// The numbers of all points to be lit.
    pub fn numbers(&self) -> impl Iterator<Item = usize> {
        let blocks = self.live.iter().enumerate();
        blocks.flat_map(|(at, live)| lanes(*live).map(move |lane| at * LANES + lane))
    }

    /// What a lane stands for.
    #[inline(always)]
    pub fn row(&self, number: usize) -> Row {
        let own = Row { point: number as u32, told: number as u32 };
        self.rows.get(number).copied().unwrap_or(own)
    }

    /// Adds a point once more.
    pub fn push_again(&mut self, other: &Self, row: usize) {
        let (number, lane) = (self.rows.len(), self.rows.len() % LANES);
        let at = number / LANES;
        if lane == 0 {
            self.live.push(0);
        }
        if at == self.blocks.len() {
            self.rays.push(Bundle::EMPTY);
            self.blocks.push(Block::EMPTY);
        }
        self.live[at] |= 1 << lane;
        self.rays[at].set(lane, &other.rays[row / LANES].query(row));
        self.blocks[at].take(number, &other.blocks[row / LANES], row);
        self.rows.push(Row { told: row as u32, ..other.row(row) });
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
    pub lit: Parts<'a>,
    pub light: Sharp,
    pub between: &'a mut [Between],
}

impl Kernel for AllFall<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { lit, light, between } = self;
        let blocks = lit.rays.iter_mut().zip(lit.blocks).zip(between);
        for ((rays, block), between) in blocks.filter(|(_, between)| between.asked != 0) {
            between.odd = Towards { light, rays, arriving: &mut block.arriving }.run();
            Fall { rays, block, share: 1.0, between }.run();
        }
    }
}

/// Adds to all points what is left of the light, now that it is known what is between.
pub(super) struct AllAdd<'a> {
    pub lit: Parts<'a>,
    pub between: &'a [Between],
    /// Whether this is all of the light, which the points show then.
    pub whole: bool,
    /// Whether what it adds is put into [`Block::sum`].
    pub kept: bool,
}

impl Kernel for AllAdd<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let blocks = self.lit.rays.iter().zip(self.lit.blocks).zip(self.between);
        for ((rays, block), between) in blocks {
            if between.passed == 0 {
                if self.kept {
                    block.sum = [ZERO; 2];
                }
                continue;
            }
            // Only now: a highlight costs more than all the rest.
            if matches!(block.power, Power::Same(_) | Power::Real) {
                strengths(rays, block);
            }
            let mut passed = [false; LANES];
            for (i, passed) in passed.iter_mut().enumerate() {
                *passed = between.passed & 1 << i != 0;
            }
            for axis in 0..3 {
                let term = &block.term[axis];
                let (mut diffuse, mut highlight) = (*term, [0.0; LANES]);
                if block.power != Power::None {
                    let (gloss, arriving) = (&block.gloss[axis], &block.arriving[axis]);
                    for i in 0..LANES {
                        highlight[i] = gloss[i] * arriving[i] * block.strength[i];
                    }
                }
                if between.tinted {
                    for i in 0..LANES {
                        diffuse[i] *= block.visibility[axis][i];
                        highlight[i] *= block.visibility[axis][i];
                    }
                }
                for i in 0..LANES {
                    diffuse[i] = if passed[i] { diffuse[i] } else { 0.0 };
                    highlight[i] = if passed[i] { highlight[i] } else { 0.0 };
                }
                if self.whole {
                    for i in 0..LANES {
                        block.own[axis][i] += diffuse[i] + highlight[i];
                    }
                }
                if self.kept {
                    (block.sum[0][axis], block.sum[1][axis]) = (diffuse, highlight);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dioptric_math::normalize;
    use dioptric_math::random::Random;
    use dioptric_math::wide::wide;

    /// What sixteen at once get of a light is to the last bit what the formulas say for one.
    #[test]
    fn sixteen_get_what_one_gets() {
        let mut random = Random::new(11);
        for exponent in [0.0, 1.0, 2.0, 7.0, 60.0, 4096.0, 1.3, 3.0827, 700.5] {
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
            (block.exponent, block.power) = match whole(exponent) {
                Some(n) => ([1.0; LANES], Power::Same(n)),
                None => ([exponent; LANES], Power::Real),
            };
            let mut between = Between { asked: !8, ..Between::default() };
            wide(Fall { rays: &rays, block: &mut block, share: 0.3, between: &mut between });
            strengths(&rays, &mut block);
            let mut expected = (0, 0);
            for (lane, &(normal, geometric, viewer, to_light, color)) in points.iter().enumerate() {
                let arriving = geometric * 0.3;
                let term = get(&block.diffuse, lane) * arriving * normal.dot(to_light);
                assert_eq!((get(&block.arriving, lane), get(&block.term, lane)), (arriving, term));
                let model = HighlightModel::Phong;
                let highlight = Highlight { model, color, exponent, image: false };
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
