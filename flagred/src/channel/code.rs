//! The numeric codes of observed quantities and statistics in plans that are exported to C.

use super::{Motors, Observed, Statistic, Threshold};

impl Statistic {
    /// The code, and the limit or percentage that belongs to it; 0 if there is none.
    pub const fn code(self) -> (u32, f64) {
        match self {
            Statistic::Mean => (0, 0.0),
            Statistic::Std => (1, 0.0),
            Statistic::Rms => (2, 0.0),
            Statistic::Min => (3, 0.0),
            Statistic::Max => (4, 0.0),
            Statistic::Last => (5, 0.0),
            Statistic::ShareBelow(limit) => (6, limit),
            Statistic::ShareAbove(limit) => (7, limit),
            Statistic::StdLessNoise => (8, 0.0),
            Statistic::Noise => (9, 0.0),
            Statistic::Rate => (10, 0.0),
            Statistic::Percentile(percent) => (11, percent),
        }
    }

    /// The statistic of a code.
    pub const fn from_code(code: u32, number: f64) -> Option<Statistic> {
        Some(match code {
            0 => Statistic::Mean,
            1 => Statistic::Std,
            2 => Statistic::Rms,
            3 => Statistic::Min,
            4 => Statistic::Max,
            5 => Statistic::Last,
            6 => Statistic::ShareBelow(number),
            7 => Statistic::ShareAbove(number),
            8 => Statistic::StdLessNoise,
            9 => Statistic::Noise,
            10 => Statistic::Rate,
            11 => Statistic::Percentile(number),
            _ => return None,
        })
    }
}

impl Motors {
    /// The code.
    pub const fn code(self) -> u32 {
        match self {
            Motors::Pooled => 0,
            Motors::Mean => 1,
            Motors::Std => 2,
            Motors::Min => 3,
            Motors::Max => 4,
            Motors::One(motor) => motor.saturating_add(5),
        }
    }

    /// The way of combining motors that has this code.
    pub const fn from_code(code: u32) -> Motors {
        match code {
            0 => Motors::Pooled,
            1 => Motors::Mean,
            2 => Motors::Std,
            3 => Motors::Min,
            4 => Motors::Max,
            5.. => Motors::One(code - 5),
        }
    }
}

impl Observed {
    /// The code, the indices of its signals or its effort, and the magnitude below which its divisor is unknown. Unused
    /// ones are 0.
    pub const fn code(self) -> (u32, [u32; 2], f64) {
        let (code, indices) = match self {
            Observed::Command => (0, [0; 2]),
            Observed::Margin => (1, [0; 2]),
            Observed::LowSide => (2, [0; 2]),
            Observed::HighSide => (3, [0; 2]),
            Observed::Named(signal) => (4, [signal as u32, 0]),
            Observed::CommandLessYaw => (5, [0; 2]),
            Observed::Effort(axis) => (6, [axis as u32, 0]),
            Observed::CommandNoise => (7, [0; 2]),
            Observed::Difference { a, b, circular } => {
                (if circular { 9 } else { 8 }, [a as u32, b as u32])
            }
            Observed::Ratio { a, b, .. } => (10, [a as u32, b as u32]),
            Observed::Product { a, b } => (11, [a as u32, b as u32]),
        };
        if let Observed::Ratio { unknown_below, .. } = self {
            return (code, indices, unknown_below);
        }
        (code, indices, 0.0)
    }

    /// The observed quantity that has this code.
    pub const fn from_code(code: u32, indices: [u32; 2], number: f64) -> Option<Observed> {
        let [first, second] = indices;
        Some(match code {
            0 => Observed::Command,
            1 => Observed::Margin,
            2 => Observed::LowSide,
            3 => Observed::HighSide,
            4 => Observed::Named(first as usize),
            5 => Observed::CommandLessYaw,
            6 => Observed::Effort(first as usize),
            7 => Observed::CommandNoise,
            8 | 9 => Observed::Difference {
                a: first as usize,
                b: second as usize,
                circular: code == 9,
            },
            10 => Observed::Ratio {
                a: first as usize,
                b: second as usize,
                unknown_below: number,
            },
            11 => Observed::Product {
                a: first as usize,
                b: second as usize,
            },
            _ => return None,
        })
    }
}

impl Threshold {
    /// The code of a threshold, and its limit; both 0 without a threshold.
    pub const fn code(threshold: Option<Threshold>) -> (u32, f64) {
        match threshold {
            None => (0, 0.0),
            Some(Threshold::Below(limit)) => (1, limit),
            Some(Threshold::Above(limit)) => (2, limit),
        }
    }

    /// The threshold that has this code, if it has one; the outer `None` means that the code is unknown.
    pub const fn from_code(code: u32, limit: f64) -> Option<Option<Threshold>> {
        Some(match code {
            0 => None,
            1 => Some(Threshold::Below(limit)),
            2 => Some(Threshold::Above(limit)),
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every code has one meaning, and every meaning has one code.
    #[test]
    fn codes_are_read_back() {
        let all = 0..1000;
        let statistics = all
            .clone()
            .map_while(|code| Statistic::from_code(code, 0.25));
        let codes: Vec<u32> = statistics
            .map(|statistic| {
                let (code, number) = statistic.code();
                assert_eq!(Statistic::from_code(code, number), Some(statistic));
                code
            })
            .collect();
        assert_eq!(codes, (0..12).collect::<Vec<u32>>());
        for code in all.clone().chain([u32::MAX]) {
            assert_eq!(Motors::from_code(code).code(), code);
        }
        let observed = all.map_while(|code| Observed::from_code(code, [3, 2], 0.5));
        let codes: Vec<u32> = observed
            .map(|observed| {
                let (code, indices, number) = observed.code();
                assert_eq!(Observed::from_code(code, indices, number), Some(observed));
                code
            })
            .collect();
        assert_eq!(codes, (0..12).collect::<Vec<u32>>());
        for threshold in [
            None,
            Some(Threshold::Below(0.5)),
            Some(Threshold::Above(2.0)),
        ] {
            let (code, limit) = Threshold::code(threshold);
            assert_eq!(Threshold::from_code(code, limit), Some(threshold));
        }
        assert_eq!(Threshold::from_code(3, 0.0), None);
    }
}
