// SPDX-License-Identifier: MIT OR Apache-2.0
//! Measured optical constants of metals.

/// A metal's index of refraction n and extinction coefficient k at [`WAVELENGTHS`].
pub(super) struct Measured {
    name: &'static str,
    n: [f64; 12],
    k: [f64; 12],
}

/// In nanometres: photon energies of 3.12 to 1.76 eV, where Johnson and Christy measured.
const WAVELENGTHS: [f64; 12] =
    [397.4, 413.3, 430.5, 450.9, 471.4, 495.9, 520.9, 548.6, 582.1, 616.8, 659.5, 704.5];

/// The metals by name. Copper, gold and silver: Johnson and Christy, "Optical Constants of the Noble
/// Metals", Phys. Rev. B 6, 4370 (1972), table I. Chromium, cobalt, iron, nickel, palladium and titanium: Johnson
/// and Christy, "Optical constants of transition metals", Phys. Rev. B 9, 5056 (1974). Aluminium: Rakic,
/// "Algorithm for the determination of intrinsic optical constants of metal films", Appl. Opt. 34, 4755
/// (1995). Brass, 70 % copper and 30 % zinc: Querry, "Optical constants", report CRDC-CR-85034 (1985). Mercury:
/// Inagaki, Arakawa and Williams, "Optical properties of liquid mercury", Phys. Rev. B 23, 5246 (1981). Platinum and
/// tungsten: the model (Brendel and Bormann's) fitted to measurements by Rakic, Djurisic, Elazar and Majewski,
/// "Optical properties of metallic films for vertical-cavity optoelectronic devices", Appl. Opt. 37, 5271 (1998).
/// What was measured at other wavelengths is interpolated to these.
#[expect(clippy::approx_constant, reason = "values that look like pi are measured")]
static METALS: [Measured; NAMES.len()] = [
    Measured {
        name: "aluminium",
        n: [0.481, 0.521, 0.572, 0.636, 0.709, 0.798, 0.892, 1.009, 1.169, 1.35, 1.624, 1.958],
        k: [4.803, 5.001, 5.215, 5.465, 5.712, 6.0, 6.291, 6.611, 6.988, 7.371, 7.8, 8.175],
    },
    Measured {
        name: "brass",
        n: [1.452, 1.387, 1.274, 1.085, 0.888, 0.71, 0.599, 0.53, 0.466, 0.45, 0.445, 0.447],
        k: [1.807, 1.791, 1.785, 1.834, 1.969, 2.207, 2.473, 2.751, 3.08, 3.406, 3.774, 4.142],
    },
    Measured {
        name: "chromium",
        n: [2.0, 2.08, 2.19, 2.33, 2.51, 2.75, 2.94, 3.18, 3.22, 3.17, 3.09, 3.05],
        k: [2.83, 2.93, 3.04, 3.14, 3.24, 3.3, 3.33, 3.33, 3.3, 3.3, 3.34, 3.39],
    },
    Measured {
        name: "cobalt",
        n: [1.571, 1.611, 1.668, 1.74, 1.811, 1.88, 1.97, 2.049, 2.13, 2.19, 2.251, 2.311],
        k: [2.933, 3.052, 3.167, 3.279, 3.412, 3.549, 3.679, 3.818, 3.96, 4.109, 4.272, 4.452],
    },
    Measured {
        name: "copper",
        n: [1.32, 1.28, 1.25, 1.24, 1.25, 1.22, 1.18, 1.02, 0.7, 0.3, 0.22, 0.21],
        k: [2.116, 2.207, 2.305, 2.397, 2.483, 2.564, 2.608, 2.577, 2.704, 3.205, 3.747, 4.205],
    },
    Measured {
        name: "gold",
        n: [1.47, 1.46, 1.45, 1.38, 1.31, 1.04, 0.62, 0.43, 0.29, 0.21, 0.14, 0.13],
        k: [1.952, 1.958, 1.948, 1.914, 1.849, 1.833, 2.081, 2.455, 2.863, 3.272, 3.697, 4.103],
    },
    Measured {
        name: "iron",
        n: [2.24, 2.35, 2.48, 2.59, 2.67, 2.74, 2.86, 2.95, 2.94, 2.88, 2.92, 2.86],
        k: [2.58, 2.65, 2.71, 2.77, 2.82, 2.88, 2.91, 2.93, 2.99, 3.05, 3.1, 3.19],
    },
    Measured {
        name: "mercury",
        n: [0.837, 0.898, 0.973, 1.065, 1.161, 1.281, 1.405, 1.545, 1.716, 1.894, 2.125, 2.368],
        k: [3.388, 3.538, 3.692, 3.87, 4.044, 4.241, 4.438, 4.641, 4.882, 5.127, 5.398, 5.668],
    },
    Measured {
        name: "nickel",
        n: [1.72, 1.7, 1.71, 1.73, 1.78, 1.82, 1.85, 1.92, 1.96, 1.99, 1.99, 2.06],
        k: [2.57, 2.69, 2.82, 2.95, 3.09, 3.25, 3.42, 3.61, 3.8, 4.02, 4.26, 4.5],
    },
    Measured {
        name: "palladium",
        n: [1.301, 1.331, 1.369, 1.41, 1.461, 1.52, 1.57, 1.639, 1.68, 1.75, 1.801, 1.861],
        k: [2.932, 3.032, 3.137, 3.259, 3.392, 3.539, 3.679, 3.838, 4.021, 4.209, 4.423, 4.652],
    },
    Measured {
        name: "platinum",
        n: [1.722, 1.761, 1.801, 1.847, 1.894, 1.95, 2.01, 2.081, 2.172, 2.274, 2.406, 2.55],
        k: [2.832, 2.925, 3.024, 3.142, 3.26, 3.402, 3.547, 3.707, 3.898, 4.089, 4.314, 4.537],
    },
    Measured {
        name: "silver",
        n: [0.05, 0.05, 0.04, 0.04, 0.05, 0.05, 0.05, 0.06, 0.05, 0.06, 0.05, 0.04],
        k: [2.07, 2.275, 2.462, 2.657, 2.869, 3.093, 3.324, 3.586, 3.858, 4.152, 4.483, 4.838],
    },
    Measured {
        name: "titanium",
        n: [2.08, 2.14, 2.21, 2.27, 2.32, 2.36, 2.44, 2.54, 2.6, 2.67, 2.76, 2.86],
        k: [2.95, 2.98, 3.01, 3.04, 3.1, 3.19, 3.3, 3.43, 3.58, 3.72, 3.84, 3.96],
    },
    Measured {
        name: "tungsten",
        n: [3.238, 3.26, 3.284, 3.314, 3.349, 3.395, 3.446, 3.504, 3.568, 3.621, 3.656, 3.655],
        k: [2.536, 2.552, 2.574, 2.607, 2.642, 2.685, 2.723, 2.757, 2.783, 2.795, 2.795, 2.79],
    },
];

/// The names, sorted.
pub(super) const NAMES: &[&str] = &[
    "aluminium",
    "brass",
    "chromium",
    "cobalt",
    "copper",
    "gold",
    "iron",
    "mercury",
    "nickel",
    "palladium",
    "platinum",
    "silver",
    "titanium",
    "tungsten",
];

impl Measured {
    /// The measurements of a metal by its name.
    pub fn of(name: &str) -> Option<&'static Self> {
        METALS.iter().find(|m| m.name == name)
    }

    /// n and k at a wavelength in nanometres.
    pub fn at(&self, wavelength: f64) -> [f64; 2] {
        [between(&self.n, wavelength), between(&self.k, wavelength)]
    }
}

/// The value at a wavelength, linearly between the table's.
fn between(values: &[f64; 12], wavelength: f64) -> f64 {
    let i = WAVELENGTHS.partition_point(|&w| w <= wavelength).clamp(1, 11);
    let share = (wavelength - WAVELENGTHS[i - 1]) / (WAVELENGTHS[i] - WAVELENGTHS[i - 1]);
    values[i - 1] + (values[i] - values[i - 1]) * share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_interpolated_between_the_table_s() {
        let gold = Measured::of("gold").unwrap();
        assert_eq!(gold.at(548.6)[1], 2.455);
        assert!((gold.at(0.5 * (548.6 + 582.1))[0] - 0.36).abs() < 1e-12);
        assert!(Measured::of("wood").is_none());
    }

    #[test]
    fn every_name_has_its_measurements() {
        assert!(NAMES.is_sorted() && NAMES.iter().zip(&METALS).all(|(n, m)| *n == m.name));
    }
}
