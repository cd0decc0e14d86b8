// SPDX-License-Identifier: MIT OR Apache-2.0
//! The sky: directions in proportion to how bright it is there.

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use dioptric_math::{DMat3, DVec3, normalize, sin, sin_cos};

use super::brightness;
use crate::light::shared::{density_in_cone, direction_in_cone};
use crate::setting::background::Background;

/// How much of the chance goes to all directions alike: whatever the table misses is found, too.
const EVEN: f64 = 0.05;
/// The size of the table where the sky is no picture, and the largest there is.
const PLAIN: [usize; 2] = [256, 128];
const LARGEST: [usize; 2] = [1024, 512];
/// The most lookups along each side of a cell.
const FINEST: usize = 4;

/// What is seen where nothing is hit.
#[derive(Clone, Debug)]
pub(super) struct Sky {
    /// `None` where it is the same everywhere.
    table: Option<Table>,
    /// About what a surface receives that faces along x, y, z, and against them, over pi.
    faces: [[f64; 3]; 2],
    mean: f64,
}

/// A density over longitude and latitude, constant in each cell.
#[derive(Clone, Debug)]
struct Table {
    /// From directions of the space of rays to right, ahead and up.
    to_own: DMat3,
    to_ray: DMat3,
    det: f64,
    size: [usize; 2],
    /// The chance of all rows up to and with each, from the bottom.
    rows: Vec<f64>,
    /// The same of the cells of each row.
    cells: Vec<f64>,
    /// The sines of the latitudes between rows: one more than rows.
    sines: Vec<f64>,
    /// Sine and cosine of the longitudes between columns: one more than columns.
    sides: Vec<[f64; 2]>,
}

impl Sky {
    /// `None` where it is black.
    pub fn new(background: &Background) -> Option<Self> {
        if let Some(radiance) = background.constant() {
            let mean = brightness(radiance);
            let faces = [[mean; 3]; 2];
            return (mean > 0.0 && mean.is_finite()).then_some(Self { table: None, faces, mean });
        }
        let frame = background.frame();
        let to_ray = frame.inverse();
        let mut sky = Self { table: None, faces: [[0.0; 3]; 2], mean: 0.0 };
        let [columns, rows] = table_size(background.picture_size());
        let fine = background
            .picture_size()
            .map_or(2, |[w, h]| w.div_ceil(columns).max(h.div_ceil(rows)).clamp(2, FINEST));
        let at = |i: usize, n: usize| i as f64 / n as f64;
        let sines: Vec<f64> = (0..=rows).map(|j| sin(PI * (at(j, rows) - 0.5))).collect();
        let mut weights = Vec::with_capacity(columns * rows);
        for j in 0..rows {
            // Of all directions.
            let solid_angle = 0.5 * (sines[j + 1] - sines[j]) / columns as f64;
            for i in 0..columns {
                let mut sum = 0.0;
                for k in 0..fine * fine {
                    let u = at(2 * (i * fine + k % fine) + 1, 2 * columns * fine);
                    let v = at(2 * (j * fine + k / fine) + 1, 2 * rows * fine);
                    let direction = to_ray * direction(u, sin(PI * (v - 0.5)));
                    sum += brightness(background.radiance(direction));
                }
                let seen = sum / (fine * fine) as f64 * solid_angle;
                let seen = if seen.is_finite() { seen } else { 0.0 };
                sky.mean += seen;
                let middle = 0.5 * (sines[j] + sines[j + 1]);
                let way = to_ray * direction(at(2 * i + 1, 2 * columns), middle);
                let way = normalize(way).unwrap_or(DVec3::Y);
                for axis in 0..3 {
                    sky.faces[0][axis] += 4.0 * seen * way[axis].max(0.0);
                    sky.faces[1][axis] += 4.0 * seen * (-way[axis]).max(0.0);
                }
                weights.push([seen, solid_angle]);
            }
        }
        if !(sky.mean > 0.0 && sky.mean.is_finite()) {
            return None;
        }
        let chance = |[seen, even]: &[f64; 2]| (1.0 - EVEN) * seen / sky.mean + EVEN * even;
        let mut total = 0.0;
        let mut row_sums = Vec::with_capacity(rows);
        let mut cells = Vec::with_capacity(columns * rows);
        for row in weights.chunks_exact(columns) {
            let first = cells.len();
            let mut sum = 0.0;
            for weight in row {
                sum += chance(weight);
                cells.push(sum);
            }
            cells[first..].iter_mut().for_each(|c| *c /= sum);
            total += sum;
            row_sums.push(total);
        }
        row_sums.iter_mut().for_each(|r| *r /= total);
        let det = frame.determinant().abs();
        let size = [columns, rows];
        let side = |i: usize| {
            let (s, c) = sin_cos(TAU * (at(i, columns) - 0.5));
            [s, c]
        };
        let sides = (0..=columns).map(side).collect();
        let rows = row_sums;
        sky.table = Some(Table { to_own: frame, to_ray, det, size, rows, cells, sines, sides });
        Some(sky)
    }

    /// About what arrives at a point with this normal, from any side without one.
    pub fn weight(&self, normal: Option<DVec3>) -> f64 {
        let Some(n) = normal else { return 4.0 * PI * self.mean };
        // The six faces blend by the squares of the normal.
        let blend = |axis: usize| n[axis] * n[axis] * self.faces[usize::from(n[axis] < 0.0)][axis];
        PI * (0.75 * (blend(0) + blend(1) + blend(2)) + 0.25 * self.mean)
    }

    /// A direction and its density.
    pub fn sample(&self, normal: Option<DVec3>, u: [f64; 2]) -> Option<(DVec3, f64)> {
        let Some(table) = &self.table else {
            let spread = if normal.is_some() { 1.0 } else { 2.0 };
            let axis = normal.unwrap_or(DVec3::Z);
            return Some((direction_in_cone(axis, spread, u), density_in_cone(spread)));
        };
        let (direction, own) = table.sample(u)?;
        let Some(normal) = normal else { return Some((direction, own)) };
        // What lies below the horizon is mirrored, so that nothing is wasted.
        let mirrored = mirror(direction, normal);
        if normal.dot(direction) < 0.0 {
            Some((mirrored, own + table.density(mirrored)))
        } else {
            Some((direction, own + table.density(mirrored)))
        }
    }

    /// The density of [`Self::sample`] in a direction.
    pub fn density(&self, normal: Option<DVec3>, direction: DVec3) -> f64 {
        match (normal, &self.table) {
            (Some(n), _) if n.dot(direction) < 0.0 => 0.0,
            (Some(_), None) => density_in_cone(1.0),
            (None, None) => density_in_cone(2.0),
            (None, Some(table)) => table.density(direction),
            (Some(n), Some(table)) => {
                table.density(direction) + table.density(mirror(direction, n))
            }
        }
    }
}

fn mirror(direction: DVec3, normal: DVec3) -> DVec3 {
    direction - normal * (2.0 * normal.dot(direction))
}

impl Table {
    fn sample(&self, u: [f64; 2]) -> Option<(DVec3, f64)> {
        let [columns, _] = self.size;
        let (row, along, share) = pick(&self.rows, u[1])?;
        let cells = self.cells.get(row * columns..(row + 1) * columns)?;
        let (column, across, own) = pick(cells, u[0])?;
        let (low, high) = (self.sines[row], self.sines[row + 1]);
        let up = low + along * (high - low);
        let way = self.to_ray * direction((column as f64 + across) / columns as f64, up);
        let direction = normalize(way)?;
        let density = share * own * columns as f64 / (TAU * (high - low));
        Some((direction, self.density_here(direction, density)))
    }

    /// The column of a direction to the right and ahead: about, and then by the sides' own directions.
    fn column(&self, right: f64, ahead: f64) -> usize {
        let n = self.size[0];
        let turn = 0.5 + rough_turn(right, ahead);
        let guess = ((turn * n as f64) as usize).min(n - 1);
        let behind = |i: usize| self.sides.get(i).is_some_and(|[s, c]| right * c - ahead * s < 0.0);
        // A side is found again half a turn further on: only the next ones are asked.
        if behind(guess) {
            (guess + n - 1) % n
        } else if behind(guess + 1) {
            guess
        } else {
            (guess + 1) % n
        }
    }

    /// The row of the sine of a latitude, in the same way.
    fn row(&self, up: f64) -> usize {
        let n = self.size[1];
        let guess = ((0.5 + rough_asin(up)) * n as f64) as usize;
        let mut row = guess.min(n - 1);
        while row > 0 && up < self.sines[row] {
            row -= 1;
        }
        while row + 1 < n && up >= self.sines[row + 1] {
            row += 1;
        }
        row
    }

    fn density(&self, direction: DVec3) -> f64 {
        let Some(own) = normalize(self.to_own * direction) else { return 0.0 };
        let [columns, _] = self.size;
        let (column, row) = (self.column(own.x, own.y), self.row(own.z));
        let Some(cells) = self.cells.get(row * columns..(row + 1) * columns) else { return 0.0 };
        let chance = step(&self.rows, row) * step(cells, column);
        let height = self.sines[row + 1] - self.sines[row];
        self.density_here(direction, chance * columns as f64 / (TAU * height))
    }

    /// A solid angle grows by `det / |m d|^3` on its way to the table's space.
    fn density_here(&self, direction: DVec3, density: f64) -> f64 {
        let length = (self.to_own * direction).length();
        density * self.det / (length * length * length)
    }
}

/// A direction from its longitude in turns, 1/2 ahead, and the sine of its latitude.
fn direction(u: f64, up: f64) -> DVec3 {
    let (s, c) = sin_cos(TAU * (u - 0.5));
    let level = ((1.0 - up) * (1.0 + up)).max(0.0).sqrt();
    DVec3::new(s * level, c * level, up)
}

/// `asin(x) / pi` to 3e-5 (Abramowitz and Stegun, "Handbook of Mathematical Functions", 1964, 4.4.45).
fn rough_asin(x: f64) -> f64 {
    let a = x.abs().min(1.0);
    let p = 1.570_728_8 + a * (-0.212_114_4 + a * (0.074_261 - 0.018_729_3 * a));
    (0.5 - (1.0 - a).sqrt() * p * FRAC_1_PI).copysign(x)
}

/// The angle from ahead to the right in turns, -1/2 to 1/2, as well (4.4.47, of the smaller ratio).
fn rough_turn(right: f64, ahead: f64) -> f64 {
    let (a, b) = (right.abs(), ahead.abs());
    let r = if a < b { a / b } else { b / a };
    let r2 = r * r;
    let p =
        0.999_866 + r2 * (-0.330_299_5 + r2 * (0.180_141 + r2 * (-0.085_133 + 0.020_835_1 * r2)));
    let angle = r * p * (0.5 * FRAC_1_PI);
    let angle = if a < b { angle } else { 0.25 - angle };
    let angle = if ahead < 0.0 { 0.5 - angle } else { angle };
    // NaN, of no direction at all, is ahead.
    if angle.is_nan() { 0.0 } else { angle.copysign(right) }
}

/// As many cells as the picture has texels, within limits.
fn table_size(picture: Option<[usize; 2]>) -> [usize; 2] {
    let Some([w, h]) = picture else { return PLAIN };
    [w.clamp(16, LARGEST[0]), h.clamp(8, LARGEST[1])]
}

/// The chance of one of some things, of which `sums` has the chances added up.
fn step(sums: &[f64], i: usize) -> f64 {
    let before = if i > 0 { sums[i - 1] } else { 0.0 };
    sums[i] - before
}

/// The thing that a number in `[0, 1)` picks, where in its share the number lies, and the share.
fn pick(sums: &[f64], u: f64) -> Option<(usize, f64, f64)> {
    let i = sums.partition_point(|&s| s <= u).min(sums.len().checked_sub(1)?);
    let (own, before) = (step(sums, i), if i > 0 { sums[i - 1] } else { 0.0 });
    (own > 0.0).then(|| (i, ((u - before) / own).clamp(0.0, 1.0), own))
}
