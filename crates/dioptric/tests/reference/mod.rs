// SPDX-License-Identifier: MIT OR Apache-2.0
//! A slow, plain second program for the report's scene: written from the scene's description alone, with
//! its own vectors, no tree of boxes, no shared code, and tolerances of its own in scene units. The
//! renderer is held against it pixel by pixel.

#![allow(clippy::disallowed_methods, missing_docs)]

use std::ops::{Add, Mul, Neg, Sub};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct V(pub f64, pub f64, pub f64);

impl Add for V {
    type Output = V;
    fn add(self, o: V) -> V {
        V(self.0 + o.0, self.1 + o.1, self.2 + o.2)
    }
}
impl Sub for V {
    type Output = V;
    fn sub(self, o: V) -> V {
        self + -o
    }
}
impl Neg for V {
    type Output = V;
    fn neg(self) -> V {
        self * -1.0
    }
}
impl Mul<f64> for V {
    type Output = V;
    fn mul(self, k: f64) -> V {
        V(self.0 * k, self.1 * k, self.2 * k)
    }
}
fn dot(a: V, b: V) -> f64 {
    a.0 * b.0 + a.1 * b.1 + a.2 * b.2
}
fn unit(a: V) -> V {
    a * (1.0 / dot(a, a).sqrt())
}
fn reflect(d: V, n: V) -> V {
    d - n * (2.0 * dot(d, n))
}
fn refract(d: V, n: V, eta: f64) -> Option<V> {
    let c = -dot(d, n);
    let k = 1.0 - eta * eta * (1.0 - c * c);
    (k >= 0.0).then(|| unit(d * eta + n * (eta * c - k.sqrt())))
}

/// What a picture gives at (u, v), v upwards.
pub type Picture = Box<dyn Fn(f64, f64) -> V>;

enum Shape {
    Sphere(V, f64),
    /// Base centre, radius, height.
    Cylinder(V, f64, f64),
    Cone(V, f64, f64),
    /// y, then x and z ranges.
    Floor(f64, [f64; 2], [f64; 2]),
    Wall(f64, [f64; 2], [f64; 2]),
    Cube(V, V),
}

#[derive(Clone, Copy, PartialEq)]
enum Paint {
    Plain(V),
    Lattice,
    Checks,
    Sky,
    Football,
}

#[derive(Clone, Copy, PartialEq)]
enum Optics {
    None,
    Mirror(f64),
    /// Own share, index of the inside over the outside.
    Clear(f64, f64),
}

struct Object {
    shape: Shape,
    paint: Paint,
    optics: Optics,
}

/// A point on a surface: distance, outward unit normal, object.
#[derive(Clone, Copy)]
struct Hit {
    t: f64,
    n: V,
    object: usize,
}

/// All places where the line meets the shape's surface.
fn meets(shape: &Shape, o: V, d: V) -> Vec<(f64, V)> {
    let mut out = Vec::new();
    let at = |t: f64| o + d * t;
    let quadratic = |a: f64, b: f64, c: f64| -> Vec<f64> {
        let q = b * b - 4.0 * a * c;
        if q < 0.0 || a == 0.0 {
            vec![]
        } else {
            vec![(-b - q.sqrt()) / (2.0 * a), (-b + q.sqrt()) / (2.0 * a)]
        }
    };
    match *shape {
        Shape::Sphere(c, r) => {
            let f = o - c;
            for t in quadratic(dot(d, d), 2.0 * dot(f, d), dot(f, f) - r * r) {
                out.push((t, unit(at(t) - c)));
            }
        }
        Shape::Cylinder(c, r, h) => {
            let (x, z) = (o.0 - c.0, o.2 - c.2);
            for t in
                quadratic(d.0 * d.0 + d.2 * d.2, 2.0 * (d.0 * x + d.2 * z), x * x + z * z - r * r)
            {
                let p = at(t);
                if p.1 >= c.1 && p.1 <= c.1 + h {
                    out.push((t, V((p.0 - c.0) / r, 0.0, (p.2 - c.2) / r)));
                }
            }
            for (y, n) in [(c.1, -1.0), (c.1 + h, 1.0)] {
                let t = (y - o.1) / d.1;
                let p = at(t);
                if (p.0 - c.0).powi(2) + (p.2 - c.2).powi(2) <= r * r {
                    out.push((t, V(0.0, n, 0.0)));
                }
            }
        }
        Shape::Cone(c, r, h) => {
            let (x, y, z, k) = (o.0 - c.0, o.1 - c.1, o.2 - c.2, r / h);
            let a = d.0 * d.0 + d.2 * d.2 - k * k * d.1 * d.1;
            let b = 2.0 * (d.0 * x + d.2 * z - k * k * d.1 * (y - h));
            for t in quadratic(a, b, x * x + z * z - k * k * (h - y) * (h - y)) {
                let p = at(t);
                if p.1 >= c.1 && p.1 <= c.1 + h {
                    let alpha = (r / h).atan();
                    let (px, pz) = (p.0 - c.0, p.2 - c.2);
                    let radius = (px * px + pz * pz).sqrt();
                    out.push((
                        t,
                        unit(V(px * alpha.cos(), radius * alpha.sin(), pz * alpha.cos())),
                    ));
                }
            }
            let t = (c.1 - o.1) / d.1;
            let p = at(t);
            if (p.0 - c.0).powi(2) + (p.2 - c.2).powi(2) <= r * r {
                out.push((t, V(0.0, -1.0, 0.0)));
            }
        }
        Shape::Floor(y, xs, zs) => {
            let t = (y - o.1) / d.1;
            let p = at(t);
            if p.0 >= xs[0] && p.0 <= xs[1] && p.2 >= zs[0] && p.2 <= zs[1] {
                out.push((t, V(0.0, 1.0, 0.0)));
            }
        }
        Shape::Wall(z, xs, ys) => {
            let t = (z - o.2) / d.2;
            let p = at(t);
            if p.0 >= xs[0] && p.0 <= xs[1] && p.1 >= ys[0] && p.1 <= ys[1] {
                out.push((t, V(0.0, 0.0, 1.0)));
            }
        }
        Shape::Cube(lo, hi) => {
            let faces = [
                (lo.0 - o.0, d.0, V(-1.0, 0.0, 0.0)),
                (hi.0 - o.0, d.0, V(1.0, 0.0, 0.0)),
                (lo.1 - o.1, d.1, V(0.0, -1.0, 0.0)),
                (hi.1 - o.1, d.1, V(0.0, 1.0, 0.0)),
                (lo.2 - o.2, d.2, V(0.0, 0.0, -1.0)),
                (hi.2 - o.2, d.2, V(0.0, 0.0, 1.0)),
            ];
            for (distance, speed, n) in faces {
                let (t, e) = (distance / speed, 1e-9);
                let p = at(t);
                let within = |x: f64, lo: f64, hi: f64| x >= lo - e && x <= hi + e;
                if within(p.0, lo.0, hi.0) && within(p.1, lo.1, hi.1) && within(p.2, lo.2, hi.2) {
                    out.push((t, n));
                }
            }
        }
    }
    out.retain(|(t, _)| t.is_finite());
    out
}

/// The report's scene.
pub struct Space {
    objects: Vec<Object>,
    sky: Picture,
    football: Picture,
    dark: V,
}

const LIGHTS: [V; 2] = [V(100.0, 100.0, 5.0), V(-100.0, 100.0, 5.0)];
const BOUNCES: u32 = 4;
/// What counts as the same place, in units of the scene.
const NEAR: f64 = 1e-7;

impl Space {
    pub fn new(sky: Picture, football: Picture, dark: V) -> Self {
        let object = |shape, paint, optics| Object { shape, paint, optics };
        let objects = vec![
            object(
                Shape::Sphere(V(-8.0, -3.0, -130.0), 13.0),
                Paint::Plain(V(0.0, 0.0, 1.0)),
                Optics::Mirror(0.7),
            ),
            object(Shape::Sphere(V(5.0, 7.0, -115.0), 3.0), Paint::Football, Optics::None),
            object(
                Shape::Sphere(V(2.0, -12.0, -80.0), 3.0),
                Paint::Plain(V(1.0, 0.0, 0.0)),
                Optics::Clear(0.3, 1.05),
            ),
            object(
                Shape::Cylinder(V(-15.0, -18.0, -90.0), 1.3, 10.0),
                Paint::Lattice,
                Optics::None,
            ),
            object(Shape::Cone(V(-15.0, -15.0, -90.0), 3.5, 5.0), Paint::Lattice, Optics::None),
            object(Shape::Cone(V(-15.0, -12.0, -90.0), 3.5, 5.0), Paint::Lattice, Optics::None),
            object(Shape::Cone(V(-15.0, -9.0, -90.0), 3.0, 5.5), Paint::Lattice, Optics::None),
            object(
                Shape::Floor(-20.0, [-60.0, 60.0], [-200.0, -40.0]),
                Paint::Checks,
                Optics::None,
            ),
            object(Shape::Wall(-200.0, [-70.0, 70.0], [-20.0, 50.0]), Paint::Sky, Optics::None),
            object(
                Shape::Cube(V(10.0, -20.0, -98.0), V(18.0, -12.0, -90.0)),
                Paint::Plain(V(0.0, 1.0, 0.0)),
                Optics::Clear(0.15, 1.005),
            ),
        ];
        Self { objects, sky, football, dark }
    }

    /// Where a ray inside of an object meets its surface from within.
    fn exit(&self, o: V, d: V, object: usize) -> Option<Hit> {
        meets(&self.objects[object].shape, o, d)
            .into_iter()
            .filter(|(t, n)| *t > -NEAR && dot(*n, d) > 0.0)
            .map(|(t, n)| Hit { t: t.max(0.0), n, object })
            .min_by(|a, b| a.t.total_cmp(&b.t))
    }

    /// The nearest surface for a ray that leaves `from`.
    fn nearest(&self, o: V, d: V, from: Option<usize>) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        for (object, it) in self.objects.iter().enumerate() {
            for (t, n) in meets(&it.shape, o, d) {
                // The point that was left is no hit; another object in the same place is.
                let least = if from == Some(object) { NEAR } else { -NEAR };
                if t > least && best.is_none_or(|b| t < b.t) {
                    best = Some(Hit { t: t.max(0.0), n, object });
                }
            }
        }
        best
    }

    fn paint(&self, hit: &Hit, p: V) -> V {
        match self.objects[hit.object].paint {
            Paint::Plain(c) => c,
            Paint::Lattice => {
                let even = |x: f64| (x.trunc() as i64) % 2 == 0;
                if even(p.0 - p.1) || even(p.0 + p.1) { V(0.0, 1.0, 0.0) } else { V(0.0, 0.0, 0.0) }
            }
            Paint::Checks => {
                let even = |x: f64| ((x + 200.0) / 4.0).floor().rem_euclid(2.0) == 0.0;
                if even(p.0) == even(p.2) { self.dark } else { V(1.0, 1.0, 1.0) }
            }
            Paint::Sky => (self.sky)((p.0 + 70.0) / 140.0, (p.1 + 20.0) / 70.0),
            Paint::Football => {
                let of = |x: f64| x.clamp(-1.0, 1.0).asin() / std::f64::consts::PI + 0.5;
                (self.football)(of(hit.n.0), of(hit.n.1))
            }
        }
    }

    fn own(&self, hit: &Hit, p: V, d: V) -> V {
        let color = self.paint(hit, p);
        let n = if dot(hit.n, d) > 0.0 { -hit.n } else { hit.n };
        let mut sum = color * 0.2;
        for light in LIGHTS {
            let way = light - p;
            let (l, distance) = (unit(way), dot(way, way).sqrt());
            if dot(l, n) <= 0.0 {
                continue;
            }
            if self.nearest(p, l, Some(hit.object)).is_some_and(|h| h.t < distance) {
                continue;
            }
            let r = reflect(-l, n);
            let highlight = dot(r, -d).max(0.0).powi(30);
            sum = sum + (color * dot(l, n) + V(highlight, highlight, highlight)) * 0.5;
        }
        sum
    }

    /// What a ray sees; `bounce` counts the secondary ones before it.
    fn trace(&self, o: V, d: V, from: Option<usize>, bounce: u32) -> V {
        let Some(hit) = self.nearest(o, d, from) else { return V(0.0, 0.0, 0.0) };
        let p = o + d * hit.t;
        let own = self.own(&hit, p, d);
        if bounce == BOUNCES {
            return own;
        }
        match self.objects[hit.object].optics {
            Optics::None => own,
            Optics::Mirror(share) => {
                own + self.trace(p, reflect(d, hit.n), Some(hit.object), bounce + 1) * share
            }
            Optics::Clear(share, ior) => {
                let Some(mut inside) = refract(d, hit.n, 1.0 / ior) else { return own };
                let mut at = p;
                for _ in 0..=64 {
                    let Some(exit) = self.exit(at, inside, hit.object) else { break };
                    at = at + inside * exit.t;
                    match refract(inside, -exit.n, ior) {
                        Some(out) => {
                            let seen = self.trace(at, out, Some(hit.object), bounce + 1);
                            return own * share + seen * (1.0 - share);
                        }
                        None => inside = reflect(inside, exit.n),
                    }
                }
                own * share
            }
        }
    }

    /// The linear value of a pixel, the report's four samples averaged, before the factor 0.8.
    pub fn pixel(&self, x: u32, y: u32, size: u32) -> [f64; 3] {
        let mut sum = V(0.0, 0.0, 0.0);
        for fy in [0.2, 0.8] {
            for fx in [0.2, 0.8] {
                // The picture plane is 20 x 20 at distance 40.
                let u = (f64::from(x) + fx) / f64::from(size) * 20.0 - 10.0;
                let v = 10.0 - (f64::from(y) + fy) / f64::from(size) * 20.0;
                sum = sum + self.trace(V(0.0, 0.0, 0.0), unit(V(u, v, -40.0)), None, 0);
            }
        }
        let mean = sum * 0.25;
        [mean.0, mean.1, mean.2]
    }
}
