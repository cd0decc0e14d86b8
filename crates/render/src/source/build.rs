// SPDX-License-Identifier: MIT OR Apache-2.0
//! From a scene's objects to surfaces that light can be looked for on.

use std::f64::consts::PI;

use dioptric_geometry::shapes::sphere::Sphere;
use dioptric_geometry::world::Hit;
use dioptric_geometry::{AnyShape, HitId, Ray};
use dioptric_math::bounds::gamma;
use dioptric_math::{DAffine3, DMat3, DVec3, Spectrum, normalize, pow};

use super::ball::Ball;
use super::emitter::{Facing, Glow, Reach, ball_around};
use super::faces::{self, Face, Faces};
use super::patch::{Moved, Patch};
use super::ring::Ring;
use super::sheet::{self, Sheet};
use super::triangles::{self, Triangles};
use super::tube::Tube;
use super::{brightness, shining};
use crate::scene::Scene;

/// At how many points the mean of a pattern's light is taken, of a whole object and of a part of many.
const LOOKS: [u32; 2] = [64, 4];
/// Objects of more parts are looked for as a whole.
const MOST_PARTS: usize = 1 << 16;

/// An object as something to look for.
pub(super) enum Glows {
    /// It does not shine, or cannot be looked for: rays find it.
    None,
    Whole(Box<Glow>),
    /// By part; nothing for those that cannot be looked for.
    Parts(Vec<Option<Glow>>),
}

/// What can be looked for of an object.
pub(super) fn glows(scene: &Scene, object: u32) -> Glows {
    let found = Shiner::new(scene, object).and_then(|shiner| {
        let shape = scene.world.shape(object)?;
        let parts = parts(shape, shiner.place);
        if let Some(parts) = parts {
            let glow = |patch: Option<Patch>| shiner.glow(patch?, LOOKS[1]);
            return Some(Glows::Parts(parts.into_iter().map(glow).collect()));
        }
        let glow = shiner.glow(patch(shape, shiner.place)?, LOOKS[0])?;
        Some(Glows::Whole(Box::new(glow)))
    });
    found.unwrap_or(Glows::None)
}

/// An object that may shine.
struct Shiner<'a> {
    scene: &'a Scene,
    object: u32,
    place: DAffine3,
    /// Its light, where that is the same everywhere and on all sides.
    uniform: Option<Spectrum>,
    solid: bool,
}

impl<'a> Shiner<'a> {
    fn new(scene: &'a Scene, object: u32) -> Option<Self> {
        let info = scene.objects.get(object as usize)?;
        if info.combined {
            return None;
        }
        let material = scene.materials.get(info.material as usize)?;
        let uniform = match &material.uniform {
            Some(finish) => {
                let outside = shining(finish, true);
                if outside == Spectrum::ZERO {
                    return None;
                }
                // Light of transparent things depends on the side that is seen.
                (outside == shining(finish, false)).then_some(outside)
            }
            None if material.material.may_shine() => None,
            None => return None,
        };
        if scene.world.is_in_group(object) {
            return None;
        }
        let id = HitId { instance: HitId::NO_INSTANCE, object, part: 0 };
        let place = scene.world.object_to_ray(id)?;
        let solid = scene.world.shape(object)?.is_solid();
        Some(Self { scene, object, place, uniform, solid })
    }

    /// A patch of it with what it sends, found out at some of its points.
    fn glow(&self, patch: Patch, looks: u32) -> Option<Glow> {
        let instance = HitId::NO_INSTANCE;
        let (mut sum, mut error, mut looked) = (0.0, 0.0_f64, 0);
        let mut outward = None;
        for (point, normal, part) in patch.spread(looks) {
            let ray = Ray::new(point, -normal);
            let hit = Hit { t: 0.0, id: HitId { instance, object: self.object, part } };
            let surface = match self.uniform {
                Some(light) => {
                    sum += brightness(light);
                    self.scene.world.surface_point(&ray, &hit)?
                }
                None => {
                    let shading = self.scene.shading(&ray, &hit)?;
                    sum += brightness(shining(&shading.finish, true));
                    shading.surface
                }
            };
            error = error.max(surface.error);
            outward = Some(surface.normal);
            looked += 1;
        }
        let (center, radius, facing, area) = reach(&patch);
        let facing = match facing {
            // Of a solid only the outside is seen. (From inside it is not looked for.)
            Facing::Both(n) if self.solid => {
                Facing::Front(n * outward.map_or(1.0, |o| 1.0_f64.copysign(o.dot(n))))
            }
            other => other,
        };
        let size = center.abs().max_element() + radius;
        let m = &self.place.matrix3;
        let stretch = norm(m) * norm(&m.inverse()) / 3.0;
        let rounding = stretch * (1.0 + error / (gamma(64) * size));
        let half = match &patch {
            Patch::Faces(faces) => faces.half(center),
            _ => DVec3::splat(radius),
        };
        let power = area * sum / f64::from(looked);
        let usable = power > 0.0 && [power, radius, rounding].iter().all(|x| x.is_finite());
        usable.then_some(Glow {
            object: self.object,
            patch,
            uniform: self.uniform,
            reach: Reach { center, radius, half, facing, power },
            rounding,
        })
    }
}

/// The parts of a shape that has many, each in its place.
fn parts(shape: &AnyShape, place: DAffine3) -> Option<Vec<Option<Patch>>> {
    let many = faces::MOST + 1..=MOST_PARTS;
    match shape {
        AnyShape::Mesh(mesh) if many.contains(&mesh.data().triangles.len()) => {
            let parts = 0..mesh.data().triangles.len() as u32;
            let face = |part| {
                let face = triangles::face(mesh, &place, part)?;
                Faces::new(vec![face], false).map(Patch::Faces)
            };
            Some(parts.map(face).collect())
        }
        AnyShape::Spheres(spheres) if spheres.len() <= MOST_PARTS => {
            let parts = 0..spheres.len() as u32;
            Some(parts.map(|part| Some(ball(spheres.get(part)?, place, part))).collect())
        }
        _ => None,
    }
}

fn ball(sphere: &Sphere, place: DAffine3, part: u32) -> Patch {
    let (center, radius) = (sphere.center(), sphere.radius());
    match similarity(&place.matrix3) {
        Some(scale) => {
            let center = place.transform_point3(center);
            Patch::Ball(Ball { center, radius: radius * scale, part })
        }
        None => moved(Patch::Ball(Ball { center, radius, part }), place),
    }
}

/// A shape in its place.
fn patch(shape: &AnyShape, place: DAffine3) -> Option<Patch> {
    let carry = |p: DVec3| place.transform_point3(p);
    let turn = |v: DVec3| place.transform_vector3(v);
    match shape {
        AnyShape::Sphere(sphere) => Some(ball(sphere, place, 0)),
        AnyShape::Disc(disc) => {
            let (center, normal, radii) = (disc.center(), disc.normal(), disc.radii());
            Some(match similarity(&place.matrix3) {
                Some(scale) => Patch::Ring(Ring {
                    center: carry(center),
                    normal: normalize(turn(normal))?,
                    radii: radii.map(|r| r * scale),
                }),
                None => moved(Patch::Ring(Ring { center, normal, radii }), place),
            })
        }
        AnyShape::Rectangle(rectangle) => {
            let (corner, edges) = rectangle.corner_and_edges();
            let mut faces = Vec::new();
            Face::parallelogram(carry(corner), edges.map(turn), 0, &mut faces);
            Faces::new(faces, false).map(Patch::Faces)
        }
        AnyShape::Triangle(triangle) => {
            let [a, b, c] = triangle.corners();
            let face = Face::triangle(carry(a), [turn(b - a), turn(c - a)], 0);
            Faces::new(face.into_iter().collect(), false).map(Patch::Faces)
        }
        AnyShape::Cuboid(cuboid) => {
            let [low, high] = cuboid.corners();
            let size = high - low;
            let mut faces = Vec::new();
            for axis in 0..3 {
                let (x, y) = ((axis + 1) % 3, (axis + 2) % 3);
                let [x, y] = [x, y].map(|k| turn(DVec3::AXES[k] * size[k]));
                let above = low + DVec3::AXES[axis] * size[axis];
                Face::parallelogram(carry(low), [y, x], 2 * axis as u32, &mut faces);
                Face::parallelogram(carry(above), [x, y], 2 * axis as u32 + 1, &mut faces);
            }
            Faces::solid(faces).map(Patch::Faces)
        }
        AnyShape::Tetrahedron(tetrahedron) => {
            let faces = tetrahedron.faces().into_iter().zip(0..);
            let faces = faces.filter_map(|([a, b, c], part)| {
                Face::triangle(carry(a), [turn(b - a), turn(c - a)], part)
            });
            Faces::solid(faces.collect()).map(Patch::Faces)
        }
        AnyShape::Polygon(polygon) => {
            let (normal, rings) = polygon.rings();
            let rings: Vec<Vec<DVec3>> =
                rings.into_iter().map(|ring| ring.into_iter().map(carry).collect()).collect();
            let normal = normalize(place.matrix3.inverse().transpose() * normal)?;
            let faces = sheet::triangles(&rings, normal)?;
            if faces.len() <= faces::MOST {
                return Faces::new(faces, false).map(Patch::Faces);
            }
            Sheet::new(faces).map(Patch::Sheet)
        }
        AnyShape::Cylinder(cylinder) => tube(cylinder.ends(), place),
        AnyShape::Cone(cone) => tube(cone.ends(), place),
        AnyShape::Mesh(mesh) if mesh.data().triangles.len() <= faces::MOST => {
            let parts = 0..mesh.data().triangles.len() as u32;
            let faces = parts.filter_map(|part| triangles::face(mesh, &place, part));
            Faces::new(faces.collect(), false).map(Patch::Faces)
        }
        AnyShape::Mesh(mesh) => Triangles::new(mesh, place).map(Patch::Triangles),
        _ => None,
    }
}

fn tube((ends, radii, open): ([DVec3; 2], [f64; 2], bool), place: DAffine3) -> Option<Patch> {
    let tube = Patch::Tube(Tube::new(ends, radii, open)?);
    Some(if place == DAffine3::IDENTITY { tube } else { moved(tube, place) })
}

fn moved(patch: Patch, place: DAffine3) -> Patch {
    Patch::Moved(Box::new(Moved::new(patch, place)))
}

/// The factor of lengths, where that is the same in all directions and angles stay.
pub(crate) fn similarity(m: &DMat3) -> Option<f64> {
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis];
    let scale2 = (x.length_squared() + y.length_squared() + z.length_squared()) / 3.0;
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-14 * scale2;
    let same = [x, y, z].iter().all(|v| near(v.length_squared(), scale2));
    let right = near(x.dot(y), 0.0) && near(y.dot(z), 0.0) && near(z.dot(x), 0.0);
    (same && right).then(|| scale2.sqrt())
}

/// The Frobenius norm.
fn norm(m: &DMat3) -> f64 {
    (m.x_axis.length_squared() + m.y_axis.length_squared() + m.z_axis.length_squared()).sqrt()
}

/// Centre and radius of a ball around a patch, whether it is flat, and the area that it shows.
fn reach(patch: &Patch) -> (DVec3, f64, Facing, f64) {
    match patch {
        Patch::Ball(Ball { center, radius, .. }) => {
            (*center, *radius, Facing::All, PI * radius * radius)
        }
        Patch::Ring(ring) => (ring.center, ring.radii[1], Facing::Both(ring.normal), ring.area()),
        Patch::Faces(faces) => {
            let all = faces.faces();
            let (center, radius) = ball_around(all.iter().flat_map(Face::corners));
            let first = all.first().map_or(DVec3::Z, |f| f.normal());
            // Two halves of one face are parallel to the last bits.
            if all.iter().all(|f| (f.normal() - first).length() < 1e-12) {
                return (center, radius, Facing::Both(first), faces.area());
            }
            // A convex solid shows a quarter of its area, in the mean (Cauchy).
            (center, radius, Facing::All, 0.25 * faces.area())
        }
        Patch::Triangles(triangles) => {
            let (center, radius) = triangles.ball();
            (center, radius, Facing::All, 0.25 * triangles.area())
        }
        Patch::Sheet(sheet) => {
            let all = sheet.faces();
            let (center, radius) = ball_around(all.iter().flat_map(Face::corners));
            let normal = all.first().map_or(DVec3::Z, |f| f.normal());
            (center, radius, Facing::Both(normal), sheet.area())
        }
        Patch::Tube(tube) => {
            let (center, radius) = tube.ball();
            (center, radius, Facing::All, 0.25 * tube.area())
        }
        Patch::Moved(moved) => {
            let (center, radius, facing, area) = reach(&moved.patch);
            let (place, normals) = moved.frames();
            let m = place.matrix3;
            let det = m.determinant().abs();
            let (facing, grown) = match facing {
                // Areas grow as volumes do, but for the growth along the normal.
                Facing::Both(n) => {
                    let turned = normals * n;
                    (Facing::Both(normalize(turned).unwrap_or(n)), det * turned.length())
                }
                other => (other, pow(det, 2.0 / 3.0)),
            };
            (place.transform_point3(center), radius * norm(&m), facing, area * grown)
        }
    }
}
