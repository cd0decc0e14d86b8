// SPDX-License-Identifier: MIT OR Apache-2.0
//! Numbers in text, scanned by hand where that is certain to give the nearest value, else by `std`.

/// Powers of ten that are exact in double precision.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

/// What separates words.
pub const fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | 0x0b | 0x0c)
}

/// The words of a line.
#[derive(Clone, Copy, Debug)]
pub struct Words<'a>(pub &'a [u8]);

impl<'a> Words<'a> {
    /// Goes to the next word; `false` at the end of the line.
    pub fn more(&mut self) -> bool {
        while let [first, rest @ ..] = self.0
            && is_space(*first)
        {
            self.0 = rest;
        }
        !self.0.is_empty()
    }

    /// The next word.
    pub fn word(&mut self) -> Option<&'a [u8]> {
        if !self.more() {
            return None;
        }
        let length = self.0.iter().position(|&b| is_space(b)).unwrap_or(self.0.len());
        let (word, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        Some(word)
    }

    /// The next word as a number; `None` at the end of the line. A word that is no number is the error.
    pub fn f32(&mut self) -> Option<Result<f32, &'a [u8]>> {
        if !self.more() {
            return None;
        }
        if let Some((value, length)) = quick(self.0) {
            self.0 = self.0.get(length..).unwrap_or_default();
            return Some(Ok(value));
        }
        let word = self.word()?;
        Some(parse(word).ok_or(word))
    }

    /// The next word as a whole number; as [`Self::f32`].
    pub fn i64(&mut self) -> Option<Result<i64, &'a [u8]>> {
        if !self.more() {
            return None;
        }
        match integer(self.0) {
            Some((value, length)) if self.0.get(length).is_none_or(|&b| is_space(b)) => {
                self.0 = self.0.get(length..).unwrap_or_default();
                Some(Ok(value))
            }
            _ => Some(Err(self.word()?)),
        }
    }
}

/// A whole number of at most 18 digits at the start of a text, and its length.
pub fn integer(text: &[u8]) -> Option<(i64, usize)> {
    let (is_negative, sign) = match text.first()? {
        b'-' => (true, 1),
        b'+' => (false, 1),
        _ => (false, 0),
    };
    let mut value = 0i64;
    let mut length = sign;
    while let Some(digit) = text.get(length).map(|b| b.wrapping_sub(b'0'))
        && digit < 10
    {
        if length >= sign + 18 {
            return None;
        }
        value = value * 10 + i64::from(digit);
        length += 1;
    }
    (length > sign).then_some((if is_negative { -value } else { value }, length))
}

/// A number at the start of a text that ends with it or goes on with space, and its length. `None` where the
/// nearest value is not certain; then [`parse`] knows.
///
/// A mantissa below 2^53 and a power of ten up to 22 are exact, so one operation gives the nearest double
/// (Clinger, "How to Read Floating Point Numbers Accurately", PLDI 1990). That rounds to the nearest single unless
/// it lies exactly between two, as the number itself then may not.
fn quick(text: &[u8]) -> Option<(f32, usize)> {
    let (is_negative, mut at) = match text.first()? {
        b'-' => (true, 1),
        b'+' => (false, 1),
        _ => (false, 0),
    };
    let mut mantissa = 0u64;
    let digits = |at: &mut usize, mantissa: &mut u64| {
        let start = *at;
        while let Some(digit) = text.get(*at).map(|b| b.wrapping_sub(b'0'))
            && digit < 10
        {
            *mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
            *at += 1;
        }
        *at - start
    };
    let mut count = digits(&mut at, &mut mantissa);
    let mut power = 0i64;
    if text.get(at) == Some(&b'.') {
        at += 1;
        let after = digits(&mut at, &mut mantissa);
        count += after;
        power = -(after as i64);
    }
    // 19 digits never overflow.
    if count == 0 || count > 19 || mantissa >= 1 << 53 {
        return None;
    }
    if let Some(b'e' | b'E') = text.get(at) {
        let (written, length) = integer(text.get(at + 1..)?)?;
        power = power.checked_add(written)?;
        at += 1 + length;
    }
    if text.get(at).is_some_and(|&b| !is_space(b)) {
        return None;
    }
    let scale = *POWERS.get(usize::try_from(power.unsigned_abs()).ok()?)?;
    let value = if power < 0 { mantissa as f64 / scale } else { mantissa as f64 * scale };
    const BETWEEN: u64 = 1 << 28;
    let is_between = value.to_bits() & (2 * BETWEEN - 1) == BETWEEN;
    let is_normal = value >= f64::from(f32::MIN_POSITIVE) && value < f64::from(f32::MAX);
    if is_between || !(is_normal || mantissa == 0) {
        return None;
    }
    Some((if is_negative { -value } else { value } as f32, at))
}

/// Any spelling of a number, those of infinity and NaN by old compilers too.
fn parse(word: &[u8]) -> Option<f32> {
    let text = std::str::from_utf8(word).ok()?;
    if let Ok(value) = text.parse() {
        return Some(value);
    }
    let (sign, body) = match text.strip_prefix('-') {
        Some(body) => (-1.0, body),
        None => (1.0, text.strip_prefix('+').unwrap_or(text)),
    };
    match body.strip_prefix("1.#")? {
        rest if rest.starts_with("INF") => Some(sign * f32::INFINITY),
        rest if ["IND", "QNAN", "SNAN"].iter().any(|n| rest.starts_with(n)) => Some(f32::NAN),
        _ => None,
    }
}

/// A word as it is shown in a message: short, and without what is no text.
pub fn shown(word: &[u8]) -> String {
    if word.is_empty() {
        return "nothing".into();
    }
    let text: String = String::from_utf8_lossy(word)
        .chars()
        .take(24)
        .map(|c| if c.is_control() { '?' } else { c })
        .collect();
    if text.len() < word.len() { format!("{text}...") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dioptric_math::random::Random;

    fn read(text: &str) -> Option<f32> {
        Words(text.as_bytes()).f32()?.ok()
    }

    #[test]
    fn numbers_are_the_nearest() {
        let mut random = Random::new(7);
        for _ in 0..200_000 {
            let bits = random.bits();
            let text = match bits % 5 {
                0 => format!("{}", f32::from_bits((bits >> 32) as u32)),
                1 => format!("{:e}", f32::from_bits((bits >> 32) as u32)),
                2 => format!("{:.6}", random.uniform(-1000.0, 1000.0)),
                3 => format!("{:.17}", random.uniform(-1.0, 1.0)),
                // Exactly between two singles, and next to that.
                _ => {
                    let odd = (bits >> 32 & 0xff_ffff) * 2 + 1;
                    format!(
                        "{odd}{}",
                        ["", ".0000000000000001", "e-3", "e10"][bits as usize / 5 % 4]
                    )
                }
            };
            let expected: f32 = text.parse().unwrap();
            let got = read(&text).unwrap();
            assert!(
                got.to_bits() == expected.to_bits() || got.is_nan(),
                "{text}: {got} {expected}"
            );
        }
    }

    #[test]
    fn odd_spellings() {
        for (text, value) in [
            ("2.", 2.0),
            (".5", 0.5),
            ("+3.", 3.0),
            ("-0", 0.0),
            ("2.e1", 20.0),
            ("1E+2", 100.0),
            ("1e-400", 0.0),
            ("1e400", f32::INFINITY),
            ("-inf", f32::NEG_INFINITY),
            ("1.#INF", f32::INFINITY),
            ("123456789012345678901234567890", 1.234_567_9e29),
        ] {
            assert_eq!(read(text), Some(value), "{text}");
        }
        assert!(read("-0").unwrap().is_sign_negative());
        for text in ["nan", "-nan", "NaN", "-1.#IND", "1.#QNAN0"] {
            assert!(read(text).unwrap().is_nan(), "{text}");
        }
        for text in ["", ".", "-", "e5", "1e", "1e+", "3.1+e2", "0x10", "1,5", "1.#", "é"] {
            assert_eq!(read(text), None, "{text}");
        }
    }

    #[test]
    fn words_and_whole_numbers() {
        let mut words = Words(b" 12\t-7  x 9/3 99999999999999999999 ");
        assert_eq!(words.i64(), Some(Ok(12)));
        assert_eq!(words.i64(), Some(Ok(-7)));
        for word in ["x", "9/3", "99999999999999999999"] {
            assert_eq!(words.i64(), Some(Err(word.as_bytes())));
        }
        assert_eq!(words.i64(), None);
        assert_eq!(integer(b"5/6"), Some((5, 1)));
    }
}
