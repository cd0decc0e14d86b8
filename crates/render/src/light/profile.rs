// SPDX-License-Identifier: MIT OR Apache-2.0
//! How a real lamp shines to each side, from the files that makers of lamps give: IES LM-63 (ANSI/IES LM-63-02), type C.

use std::sync::Arc;

use dioptric_math::{DVec3, acos, atan2, normalize, sin_cos};
use dioptric_scene::{Args, Default, Diagnostic, Param, Type};

use crate::build::Builder;
use crate::setting::root::Root;

/// `profile`.
pub(super) const PROFILE: Param = Param::new(
    "profile",
    Type::File,
    Default::Absent,
    "An IES file (LM-63, type C) that says how bright it is to each side, as a share of its brightest one.",
);

/// `profile_turn`.
pub(super) const PROFILE_TURN: Param = Param::new(
    "profile_turn",
    Type::NUMBER,
    Default::Number(0.0),
    "Turns the profile around the lamp's axis, in degrees.",
);

/// Numbers that one file may hold.
const MOST: usize = 1 << 20;

/// Shares of the brightest direction, by angles in degrees.
#[derive(Clone, Debug, PartialEq)]
struct Table {
    /// From the axis, growing.
    vertical: Vec<f64>,
    /// Around it, growing; from 0 to 0, 90, 180 or 360, and mirrored beyond.
    horizontal: Vec<f64>,
    /// For each of `horizontal` those of `vertical`.
    shares: Vec<f64>,
}

/// A profile around an axis.
#[derive(Clone, Debug)]
pub(super) struct Profile {
    table: Arc<Table>,
    /// Unit vectors in the space of rays: along the axis, to the angle 0 around it, and to 90 degrees.
    axis: DVec3,
    sides: [DVec3; 2],
}

impl Profile {
    /// Reads [`PROFILE`] and [`PROFILE_TURN`], around an axis of the file's space.
    pub fn from_args(
        args: &Args,
        builder: &Builder,
        root: &Root,
        axis: DVec3,
    ) -> Result<Option<Self>, Diagnostic> {
        if !args.is_written("profile") {
            return Ok(None);
        }
        let path = args.text("profile")?;
        let place = args.description.argument_span(args.id, "profile");
        let bytes = builder.loader.read(&path).map_err(|why| why.diagnostic().at(place, ""))?;
        let table = read(&String::from_utf8_lossy(&bytes)).map_err(|(line, what)| {
            let message = format!("{path}, line {line}: {what}");
            args.error("profile", "profile-damaged", message)
                .help("an IES file of LM-63, photometry of type C, is what lamps' makers give")
        })?;
        // Plane 0 holds the x axis, or z for lamps along x.
        let reference = if axis.x.abs() < 0.9 { DVec3::X } else { DVec3::Z };
        let across = normalize(reference - axis * reference.dot(axis)).unwrap_or(DVec3::X);
        let (s, c) = sin_cos(args.number("profile_turn")?.to_radians());
        let on = across.cross(axis);
        let ray = |v: DVec3| normalize(root.vector(v)).unwrap_or(v);
        let sides = [ray(across * c + on * s), ray(on * c - across * s)];
        Ok(Some(Self { table: Arc::new(table), axis: ray(axis), sides }))
    }

    /// The share in the direction of a unit vector away from the lamp.
    pub fn share(&self, away: DVec3) -> f64 {
        let vertical = acos(away.dot(self.axis).clamp(-1.0, 1.0)).to_degrees();
        let [x, y] = self.sides.map(|side| away.dot(side));
        let around = atan2(y, x).to_degrees();
        self.table.share(vertical, if around < 0.0 { around + 360.0 } else { around })
    }
}

impl Table {
    fn share(&self, vertical: f64, around: f64) -> f64 {
        let last = self.horizontal.last().copied().unwrap_or(0.0);
        let around = match last {
            x if x > 180.0 => around,
            x if x > 90.0 => {
                if around > 180.0 {
                    360.0 - around
                } else {
                    around
                }
            }
            _ => {
                let half = around % 180.0;
                if half > 90.0 { 180.0 - half } else { half }
            }
        };
        let (Some((row, down)), Some((column, across))) =
            (place(&self.vertical, vertical), place_within(&self.horizontal, around))
        else {
            return 0.0;
        };
        let at = |column: usize, row: usize| {
            let place = column.min(self.horizontal.len() - 1) * self.vertical.len() + row;
            self.shares.get(place).copied().unwrap_or(0.0)
        };
        let along = |column: usize| {
            let near = at(column, row);
            near + (at(column, (row + 1).min(self.vertical.len() - 1)) - near) * down
        };
        let near = along(column);
        near + (along(column + 1) - near) * across
    }
}

/// The angle of a table before `x`, and how far on `x` is to the next; nothing outside of the table.
fn place(angles: &[f64], x: f64) -> Option<(usize, f64)> {
    let (first, last) = (angles.first()?, angles.last()?);
    (x >= first - 1e-9 && x <= last + 1e-9).then(|| place_within(angles, x))?
}

/// The same; outside of the table its end.
fn place_within(angles: &[f64], x: f64) -> Option<(usize, f64)> {
    let before = angles.partition_point(|&a| a <= x).saturating_sub(1);
    let low = angles.get(before)?;
    let Some(high) = angles.get(before + 1) else { return Some((before, 0.0)) };
    Some((before, ((x - low) / (high - low)).clamp(0.0, 1.0)))
}

/// Numbers of a text with the lines on which they stand.
struct Numbers<'a> {
    words: Box<dyn Iterator<Item = (usize, &'a str)> + 'a>,
    line: usize,
}

/// A line, and what is wrong on it.
type Wrong = (usize, String);

impl<'a> Numbers<'a> {
    fn next(&mut self, what: &str) -> Result<f64, Wrong> {
        let Some((line, word)) = self.words.next() else {
            return Err((self.line, format!("the file ends before {what}")));
        };
        self.line = line;
        match word.parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(x),
            _ => Err((line, format!("expected {what}, got \"{}\"", word.escape_debug()))),
        }
    }

    fn count(&mut self, what: &str) -> Result<usize, Wrong> {
        let x = self.next(what)?;
        if x.trunc() == x && (1.0..=MOST as f64).contains(&x) {
            return Ok(x as usize);
        }
        Err((self.line, format!("expected {what}, a whole number of at least 1, got {x}")))
    }

    fn many(&mut self, n: usize, what: &str) -> Result<Vec<f64>, Wrong> {
        (0..n).map(|_| self.next(what)).collect()
    }

    fn angles(&mut self, n: usize, what: &str) -> Result<Vec<f64>, Wrong> {
        let angles = self.many(n, what)?;
        if angles.windows(2).any(|w| w[1] <= w[0]) {
            return Err((self.line, format!("{what}s do not grow")));
        }
        Ok(angles)
    }
}

fn read(text: &str) -> Result<Table, Wrong> {
    let lines: Vec<&str> = text.lines().collect();
    let tilt = lines.iter().position(|line| line.trim_start().starts_with("TILT="));
    let Some(tilt) = tilt else {
        return Err((lines.len().max(1), "there is no TILT= line".into()));
    };
    let rest = lines[tilt + 1..].iter().zip(tilt + 2..).flat_map(|(line, number)| {
        let words = line.split(|c: char| c.is_whitespace() || c == ',');
        words.filter(|w| !w.is_empty()).map(move |w| (number, w))
    });
    let mut numbers = Numbers { words: Box::new(rest), line: tilt + 1 };
    match lines[tilt].trim().trim_start_matches("TILT=").trim() {
        "NONE" => {}
        "INCLUDE" => {
            // For lamps that dim when tilted: ours are not.
            numbers.next("how the lamp lies")?;
            let pairs = numbers.count("the number of tilts")?;
            numbers.many(2 * pairs, "a tilt")?;
        }
        other => {
            let what = format!("TILT={} names another file", other.escape_debug());
            return Err((tilt + 1, format!("{what}; only NONE and INCLUDE are read")));
        }
    }
    numbers.many(3, "lamps, lumens and the multiplier")?;
    let (rows, columns) = (
        numbers.count("the number of vertical angles")?,
        numbers.count("the number of horizontal angles")?,
    );
    let kind = numbers.next("the photometric type")?;
    if kind != 1.0 {
        let name = if kind == 2.0 { "B" } else { "A" };
        return Err((numbers.line, format!("photometry of type {name}: only type C is read")));
    }
    numbers.many(7, "a size, a factor or watts")?;
    if rows.saturating_mul(columns) > MOST {
        return Err((numbers.line, format!("more than {MOST} values")));
    }
    let vertical = numbers.angles(rows, "vertical angle")?;
    let horizontal = numbers.angles(columns, "horizontal angle")?;
    let (first, last) = (horizontal.first().copied(), horizontal.last().copied());
    let ends = [Some(0.0), Some(90.0), Some(180.0), Some(360.0)];
    if first != Some(0.0) || !ends.contains(&last) {
        let what = "horizontal angles go from 0 to 0, 90, 180 or 360";
        return Err((
            numbers.line,
            format!("{what}, not from {first:?} to {last:?}").replace("Some(", "").replace(')', ""),
        ));
    }
    let mut shares = numbers.many(rows * columns, "candelas")?;
    let most = shares.iter().fold(0.0, |most: f64, x| most.max(*x));
    if !(most > 0.0) {
        return Err((numbers.line, "it is dark on all sides".into()));
    }
    shares.iter_mut().for_each(|x| *x = (*x / most).max(0.0));
    Ok(Table { vertical, horizontal, shares })
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "IESNA:LM-63-2002\n[MANUFAC] none\nTILT=NONE\n1 1000 1 ";

    #[test]
    fn shares_are_interpolated_and_mirrored() {
        let text = format!("{HEAD}3 2 1 2 0 0 0\n1 1 10\n0 45 90\n0, 90\n100 50 0\n100 100 20\n");
        let table = read(&text).unwrap();
        for (vertical, around, expected) in [
            (0.0, 0.0, 1.0),
            (22.5, 0.0, 0.75),
            (45.0, 45.0, 0.75),
            (45.0, 135.0, 0.75),
            (45.0, 315.0, 0.75),
            (90.0, 90.0, 0.2),
            (90.0, 270.0, 0.2),
            (67.5, 180.0, 0.25),
            (91.0, 0.0, 0.0),
        ] {
            let share = table.share(vertical, around);
            assert!((share - expected).abs() < 1e-12, "{vertical} {around}: {share}");
        }
        let round = read(&format!("{HEAD}2 1 1 2 0 0 0\n1 1 10\n0 180\n0\n4 8\n")).unwrap();
        assert_eq!((round.share(90.0, 77.0), round.share(180.0, 300.0)), (0.75, 1.0));
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        let wrong = |rest: &str| read(&format!("{HEAD}{rest}")).unwrap_err();
        assert_eq!(read("a\nb").unwrap_err(), (2, "there is no TILT= line".into()));
        assert_eq!(wrong("2 x"), (4, "expected the number of horizontal angles, got \"x\"".into()));
        assert_eq!(wrong("2 1 2"), (4, "photometry of type B: only type C is read".into()));
        assert_eq!(
            wrong("2 1 1 2 0 0 0\n1 1 10\n0 90\n0\n3"),
            (8, "the file ends before candelas".into())
        );
        assert_eq!(
            wrong("2 1 1 2 0 0 0\n1 1 10\n90 0\n0\n3 4"),
            (6, "vertical angles do not grow".into())
        );
        assert_eq!(wrong("0 1").0, 4);
        assert_eq!(
            wrong("1 2 1 2 0 0 0\n1 1 10\n0\n0 70\n3 4").1,
            "horizontal angles go from 0 to 0, 90, 180 or 360, not from 0.0 to 70.0"
        );
        let other = read("TILT=lamp.tlt\n").unwrap_err();
        assert_eq!(other.0, 1);
        // Anything at all gives an answer.
        for text in ["", "TILT=NONE", "TILT=INCLUDE\n1 99999999 1", "TILT=NONE\n1e999"] {
            assert!(read(text).is_err());
        }
    }
}
