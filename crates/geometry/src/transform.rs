// SPDX-License-Identifier: MIT OR Apache-2.0
//! Affine transforms with their inverses, and how they carry points, normals and errors.

use dioptric_math::bounds::gamma;
use dioptric_math::{DAffine3, DMat3, DVec3, normalize};

use crate::bounds::Bounds;
use crate::shape::{LocalSurface, SurfacePoint};

/// The Frobenius norm of the identity.
const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// From an object's own space to the space of the scene, and back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    to_world: DAffine3,
    to_local: DAffine3,
    /// Largest stretch of a vector, from above: the Frobenius norm.
    stretch: f64,
    /// The same for the way back.
    shrink: f64,
}

impl Transform {
    /// Both spaces are the same.
    pub const IDENTITY: Self = Self {
        to_world: DAffine3::IDENTITY,
        to_local: DAffine3::IDENTITY,
        stretch: SQRT_3,
        shrink: SQRT_3,
    };

    /// The transform of a matrix; `None` where it is not finite or has no inverse that is worth the
    /// name: where the stretches of different directions are 10^15 apart, nothing but rounding is left.
    #[must_use]
    pub fn new(to_world: DAffine3) -> Option<Self> {
        let to_local = to_world.inverse();
        let norm = |m: &DMat3| {
            (m.x_axis.length_squared() + m.y_axis.length_squared() + m.z_axis.length_squared())
                .sqrt()
        };
        let (stretch, shrink) = (norm(&to_world.matrix3), norm(&to_local.matrix3));
        let usable = to_world.is_finite()
            && to_local.is_finite()
            && to_world.matrix3.determinant() != 0.0
            && stretch * shrink < 1e15;
        usable.then_some(Self { to_world, to_local, stretch, shrink })
    }

    /// The matrix to the scene's space.
    #[must_use]
    pub const fn to_world(&self) -> &DAffine3 {
        &self.to_world
    }

    /// The matrix to the object's space.
    #[must_use]
    pub const fn to_local(&self) -> &DAffine3 {
        &self.to_local
    }

    /// The largest factor by which it can stretch a vector, from above, and the same of its inverse.
    #[must_use]
    pub const fn norms(&self) -> (f64, f64) {
        (self.stretch, self.shrink)
    }

    /// Whether it turns left hands into right ones.
    #[must_use]
    pub fn is_mirror(&self) -> bool {
        self.to_world.matrix3.determinant() < 0.0
    }

    /// A point and the bound of its error, carried to the object's space.
    #[inline]
    #[must_use]
    pub fn point_to_local(&self, point: DVec3, error: f64) -> (DVec3, f64) {
        carry(&self.to_local, self.shrink, point, error)
    }

    /// A point and the bound of its error, carried to the scene's space.
    #[inline]
    #[must_use]
    pub fn point_to_world(&self, point: DVec3, error: f64) -> (DVec3, f64) {
        carry(&self.to_world, self.stretch, point, error)
    }

    /// A direction, carried to the object's space; its length changes with the transform's.
    #[inline]
    #[must_use]
    pub fn direction_to_local(&self, direction: DVec3) -> DVec3 {
        self.to_local.matrix3 * direction
    }

    /// A normal, carried to the scene's space by the inverse's transpose and made a unit vector.
    #[inline]
    #[must_use]
    pub fn normal_to_world(&self, normal: DVec3) -> DVec3 {
        normalize(self.to_local.matrix3.transpose() * normal).unwrap_or(normal)
    }

    /// A box around the carried box.
    #[must_use]
    pub fn bounds_to_world(&self, bounds: Bounds) -> Bounds {
        if bounds.is_finite() {
            let carried = bounds.corners().map(|c| self.point_to_world(c, 0.0));
            let error = carried.iter().fold(0.0_f64, |e, (_, pe)| e.max(*pe));
            let tight = Bounds::of(carried.map(|(p, _)| p));
            Bounds { min: tight.min - error, max: tight.max + error }
        } else if bounds.is_empty() {
            Bounds::EMPTY
        } else {
            Bounds::EVERYTHING
        }
    }

    /// A point of a surface, carried to the scene's space.
    #[must_use]
    pub fn surface_point_to_world(&self, s: &SurfacePoint) -> SurfacePoint {
        let (point, error) = self.point_to_world(s.point, s.error);
        let normal = self.normal_to_world(s.normal);
        let shading_normal = if s.shading_normal == s.normal {
            normal
        } else {
            self.normal_to_world(s.shading_normal)
        };
        SurfacePoint { point, error, normal, shading_normal }
    }

    /// A surface, carried to the scene's space.
    #[must_use]
    pub fn surface_to_world(&self, s: &LocalSurface) -> LocalSurface {
        let SurfacePoint { point, error, normal, shading_normal } =
            self.surface_point_to_world(&(*s).into());
        LocalSurface {
            point,
            error,
            normal,
            shading_normal,
            uv: s.uv,
            dpdu: self.to_world.matrix3 * s.dpdu,
            dpdv: self.to_world.matrix3 * s.dpdv,
        }
    }
}

/// Error of `M p + t` in each lane: at most `gamma(4) (|M| |p| + |t|)`, plus the carried error
/// (Pharr, Jakob and Humphreys, "Physically Based Rendering", 3rd ed., section 3.9.4).
fn carry(m: &DAffine3, norm: f64, point: DVec3, error: f64) -> (DVec3, f64) {
    let abs =
        DMat3::from_cols(m.matrix3.x_axis.abs(), m.matrix3.y_axis.abs(), m.matrix3.z_axis.abs());
    let rounding = (abs * point.abs() + m.translation.abs()).length() * gamma(4);
    (m.transform_point3(point), rounding + error * norm)
}
