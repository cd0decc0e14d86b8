// SPDX-License-Identifier: MIT OR Apache-2.0
//! The transparent objects that a ray is inside of, innermost last.

use dioptric_geometry::HitId;
use dioptric_math::{Spectrum, exp};

use crate::scene::Scene;

/// One transparent object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// A hit on it: which object of which instance.
    pub object: HitId,
    /// Its index of refraction.
    pub ior: f64,
    /// What it absorbs per unit of the file.
    pub absorption: Spectrum,
    /// Of media that overlap the one of the highest priority is there, among equal ones the one entered last.
    pub priority: i32,
}

/// The innermost object (of those with the highest priority) around a ray, as its place in the [`Media`] of the sample; `None` outside of
/// all. Rays of one tree share the list, so that a ray carries one number.
pub type Inside = Option<u32>;

/// The two sides of a surface that bends rays: where the ray comes from, and beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sides {
    /// Indices of refraction on the near side and on the far one.
    pub ior: [f64; 2],
    /// What is around a ray that is reflected.
    pub near: Inside,
    /// What is around a ray that goes through.
    pub far: Inside,
}

impl Sides {
    /// The index on the near side over that on the far one.
    #[must_use]
    pub fn eta(&self) -> f64 {
        self.ior[0] / self.ior[1]
    }
}

/// All surroundings that the rays of one sample have been in.
#[derive(Debug)]
pub struct Media {
    /// Each medium with what is around it. Empty (and without memory) until a ray enters something.
    nested: Vec<(Medium, Inside)>,
    /// Index of refraction outside of all objects.
    around: f64,
}

impl Media {
    /// Nothing entered yet, in a space with this index of refraction.
    #[must_use]
    pub const fn new(around: f64) -> Self {
        Self { nested: Vec::new(), around }
    }

    /// Whether nothing was entered so far.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.nested.is_empty()
    }

    /// The innermost medium.
    #[must_use]
    pub fn top(&self, inside: Inside) -> Option<&Medium> {
        self.entry(inside).map(|(medium, _)| medium)
    }

    /// Index of refraction where the ray is.
    #[must_use]
    pub fn ior(&self, inside: Inside) -> f64 {
        self.top(inside).map_or(self.around, |m| m.ior)
    }

    /// Whether the ray is inside this object.
    #[must_use]
    pub fn contains(&self, mut inside: Inside, object: &HitId) -> bool {
        while let Some((medium, outer)) = self.entry(inside) {
            if medium.object.same_object(object) {
                return true;
            }
            inside = *outer;
        }
        false
    }

    /// Whether the ray is inside this object and nothing else.
    #[must_use]
    pub fn is_last(&self, inside: Inside, object: &HitId) -> bool {
        self.entry(inside).is_some_and(|(m, outer)| outer.is_none() && m.object.same_object(object))
    }

    /// What the innermost medium, or what fills the space between things, leaves of light over a distance in the space
    /// of rays; fog aside.
    #[must_use]
    pub fn transmittance(&self, scene: &Scene, inside: Inside, distance: f64) -> Spectrum {
        match self.top(inside) {
            Some(medium) => absorbed(medium.absorption, distance / scene.root.scale()),
            None => scene.surroundings.transmittance(distance),
        }
    }

    /// With one more object around the ray: below those of a higher priority.
    pub fn enter(&mut self, inside: Inside, medium: Medium) -> Inside {
        if let Some(&(top, outer)) =
            self.entry(inside).filter(|(m, _)| m.priority > medium.priority)
        {
            let below = self.enter(outer, medium);
            return self.enter(below, top);
        }
        self.nested.push((medium, inside));
        Some(self.nested.len() as u32 - 1)
    }

    /// Without the innermost entry of this object, wherever it is among the others.
    pub fn leave(&mut self, inside: Inside, object: &HitId) -> Inside {
        if !self.contains(inside, object) {
            return inside;
        }
        let &(medium, outer) = self.entry(inside)?;
        if medium.object.same_object(object) {
            return outer;
        }
        // Objects that overlap are left in another order than they were entered.
        let outer = self.leave(outer, object);
        self.enter(outer, medium)
    }

    /// What lies on the two sides of the surface of `medium`'s object where a ray meets it, from outside or from
    /// inside. `solid` tells whether the object has an inside: a pane has none, and what goes through goes on in
    /// what it came from.
    pub fn sides(&mut self, inside: Inside, medium: &Medium, outside: bool, solid: bool) -> Sides {
        let object = &medium.object;
        if !solid {
            return Sides { ior: [self.ior(inside), medium.ior], near: inside, far: inside };
        }
        let outer = self.leave(inside, object);
        if outside {
            let far = self.enter(outer, *medium);
            return Sides { ior: [self.ior(outer), self.ior(far)], near: outer, far };
        }
        // An object that the ray is not known to have entered is left all the same.
        let near = if self.contains(inside, object) { inside } else { self.enter(inside, *medium) };
        Sides { ior: [self.ior(near), self.ior(outer)], near, far: outer }
    }

    /// Whether a solid's surface is not there: something of a higher priority is on both of its sides.
    #[must_use]
    pub fn is_hidden(&self, sides: &Sides, medium: &Medium, outside: bool) -> bool {
        let within = if outside { sides.far } else { sides.near };
        sides.near != sides.far
            && self.top(within).is_some_and(|top| top.priority > medium.priority)
    }

    /// The same objects with other indices of refraction.
    pub fn with_indices(&mut self, inside: Inside, index: &impl Fn(&Medium) -> f64) -> Inside {
        let &(medium, outer) = self.entry(inside)?;
        let outer = self.with_indices(outer, index);
        self.enter(outer, Medium { ior: index(&medium), ..medium })
    }

    fn entry(&self, inside: Inside) -> Option<&(Medium, Inside)> {
        self.nested.get(inside? as usize)
    }
}

/// What is left of light after a distance in an absorbing medium (Beer and Lambert). A lane that
/// absorbs nothing stays 1 over an infinite distance.
#[must_use]
pub fn absorbed(absorption: Spectrum, distance: f64) -> Spectrum {
    if absorption == Spectrum::ZERO {
        return Spectrum::ONE;
    }
    let lane = |a: f64| if a > 0.0 { exp(-a * distance) } else { 1.0 };
    Spectrum::from(absorption.to_array().map(lane))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn medium(object: u32, ior: f64) -> Medium {
        let object = HitId { instance: 0, object, part: 0 };
        Medium { object, ior, absorption: Spectrum::ZERO, priority: 0 }
    }

    #[test]
    fn leaving_in_any_order_restores_the_outer_medium() {
        let mut media = Media::new(1.0);
        let one = media.enter(None, medium(1, 1.5));
        let both = media.enter(one, medium(2, 1.33));
        let mut after = |objects: &[u32]| {
            let left = objects.iter().fold(both, |i, &o| media.leave(i, &medium(o, 0.0).object));
            media.ior(left)
        };
        assert_eq!(after(&[]), 1.33);
        assert_eq!(after(&[2]), 1.5);
        assert_eq!(after(&[1]), 1.33);
        assert_eq!(after(&[3]), 1.33);
        assert_eq!(after(&[1, 2]), 1.0);
        assert_eq!(after(&[2, 1]), 1.0);
    }

    #[test]
    fn the_highest_priority_is_there_in_whatever_order_things_are_entered() {
        let mut media = Media::new(1.0);
        let glass = Medium { priority: 2, ..medium(1, 1.5) };
        let water = Medium { priority: 1, ..medium(2, 1.33) };
        let ice = Medium { priority: 3, ..medium(3, 1.31) };
        // Into the glass, into the water within its wall, out of the glass, out of the water.
        let wall = media.sides(None, &glass, true, true);
        assert!(wall.ior == [1.0, 1.5] && !media.is_hidden(&wall, &glass, true));
        let within = media.sides(wall.far, &water, true, true);
        assert!(within.ior == [1.5, 1.5] && media.is_hidden(&within, &water, true));
        let inner = media.sides(within.far, &glass, false, true);
        assert!(inner.ior == [1.5, 1.33] && !media.is_hidden(&inner, &glass, false));
        let top = media.sides(inner.far, &water, false, true);
        assert!(top.ior == [1.33, 1.0] && !media.is_hidden(&top, &water, false));
        // Out of the water first, within the ice.
        let all = [water, ice, glass].iter().fold(None, |i, &m| media.enter(i, m));
        assert_eq!(media.ior(all), 1.31);
        let hidden = media.sides(all, &water, false, true);
        assert!(hidden.ior == [1.31, 1.31] && media.is_hidden(&hidden, &water, false));
        let left = media.leave(hidden.far, &ice.object);
        assert_eq!(media.ior(left), 1.5);
    }

    #[test]
    fn rays_of_one_tree_do_not_disturb_each_other() {
        let mut media = Media::new(1.2);
        let glass = media.enter(None, medium(1, 1.5));
        let _water_in_glass = media.enter(glass, medium(2, 1.33));
        assert_eq!(media.ior(glass), 1.5);
        assert!(!media.contains(glass, &medium(2, 0.0).object));
        assert_eq!(media.ior(None), 1.2);
    }
}
