//! Writes a flight as CSV.

use std::io::{self, Write};

use super::header::WRITER;
use crate::{Basis, Flight, Hold, VehicleKind};

impl Flight {
    /// Writes the flight as CSV: header lines with its vehicle and ranges, then a row for each row of motor commands,
    /// with the latest value of every signal at that time. A take-off or a landing between two of these rows has its
    /// own row without commands. A flight without motor commands has a row for each row of its longest series.
    ///
    /// Commands in us are written unchanged (`pwm1`..), all others as fractions of the full range (`motor1`..). Unknown
    /// values are empty cells. Numbers are written so that they are read back exactly. Texts that a spreadsheet would
    /// interpret as a formula are preceded by an apostrophe.
    ///
    /// # Errors
    ///
    /// If writing to `out` fails.
    ///
    /// ```
    /// let log = "t_s,motor1,motor2,in_air\n0,0.5,0.25,0\n0.1,0.75,0.5,1\n";
    /// let flight = flagred_flightlog::read(log.as_bytes(), &flagred_flightlog::Options::default())?;
    /// let mut written = Vec::new();
    /// flight.write_csv(&mut written)?;
    /// let again = flagred_flightlog::read(&written[..], &flagred_flightlog::Options::default())?;
    /// assert_eq!(again.commands, flight.commands);
    /// assert_eq!(again.in_air, flight.in_air);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn write_csv(&self, mut out: impl Write) -> io::Result<()> {
        let out: &mut dyn Write = &mut out;
        self.write_header(out)?;
        let in_us = self.range.as_ref().is_none_or(|range| range.unit == "us");
        let stem = if in_us { "pwm" } else { "motor" };
        write!(out, "t_s")?;
        let motors = self.motors.len();
        for number in 1..=motors {
            write!(out, ",{stem}{number}")?;
        }
        // If the state is unknown, the column is empty: without the column, every row would count
        // as in the air.
        write!(out, ",in_air")?;
        for signal in self.signals() {
            write!(out, ",{}", quoted(&signal.label.name))?;
        }
        writeln!(out)?;

        let mut holds: Vec<Hold<'_>> = self.signals().map(|signal| signal.hold()).collect();
        let mut write_row = |out: &mut dyn Write, t_s: f64, commands: &[f64]| {
            write!(out, "{t_s}")?;
            for &raw in commands {
                let known = if in_us { Some(raw) } else { self.command(raw) };
                cell(out, known.filter(|value| value.is_finite()))?;
            }
            cell(
                out,
                self.is_in_air(t_s).map(|in_air| u8::from(in_air).into()),
            )?;
            for hold in &mut holds {
                cell(out, hold.at(t_s))?;
            }
            writeln!(out)
        };
        // A take-off or a landing between two rows has its own row, without commands.
        let mut changes = self.air_changes().into_iter().peekable();
        let unknown = vec![f64::NAN; motors];
        let has_samples = !self.commands.is_empty();
        let mut row = |out: &mut dyn Write, t_s: f64, commands: &[f64]| {
            while let Some(change_s) = changes.next_if(|change_s| *change_s <= t_s) {
                // A sample without a known command needs a separate row for the change too, because a row without commands
                // that changes the state is not read as a sample.
                let is_unknown = has_samples && commands.iter().all(|raw| raw.is_nan());
                if change_s < t_s || is_unknown {
                    write_row(out, change_s, &unknown)?;
                }
            }
            match t_s.is_finite() {
                true => write_row(out, t_s, commands),
                false => Ok(()),
            }
        };
        if has_samples {
            for (t_s, raw) in self.commands.rows() {
                row(out, t_s, raw)?;
            }
            return row(out, f64::INFINITY, &[]);
        }
        let longest = self
            .series
            .iter()
            .map(|series| series.t_s())
            .max_by_key(|t_s| t_s.len());
        for &t_s in longest.unwrap_or_default() {
            row(out, t_s, &unknown)?;
        }
        row(out, f64::INFINITY, &[])
    }

    /// The times of take-offs and landings, in order.
    fn air_changes(&self) -> Vec<f64> {
        let spans = self.in_air.iter().flat_map(|in_air| &in_air.spans);
        let times = spans.flat_map(|span| {
            let end_s = (!span.ends_with_log).then_some(span.end_s);
            [Some(span.start_s), end_s]
        });
        times.flatten().collect()
    }

    fn write_header(&self, out: &mut dyn Write) -> io::Result<()> {
        let mut known = Vec::new();
        let mut line = |out: &mut dyn Write, key: &str, value: &str| {
            known.push(key.to_owned());
            writeln!(out, "# {}: {}", comment(key), comment(value))
        };
        let vehicle = &self.vehicle;
        if let Some(frame) = &vehicle.frame {
            line(out, "vehicle", frame)?;
        }
        if let Some(id) = &vehicle.id {
            line(out, "vehicle_id", id)?;
        }
        if let Some(id) = vehicle.system_id {
            line(out, "system_id", &id.to_string())?;
        }
        if let Some(count) = vehicle.boot_count {
            line(out, "boot_count", &count.to_string())?;
        }
        if vehicle.kind != VehicleKind::Unknown {
            line(out, "vehicle_kind", &vehicle.kind.to_string())?;
        }
        if let Some(firmware) = &vehicle.firmware {
            line(out, "firmware", firmware)?;
        }
        if let Some(range) = self.range.as_ref().filter(|range| range.unit == "us") {
            line(out, "pwm_low_us", &range.low.to_string())?;
            line(out, "pwm_high_us", &range.high.to_string())?;
        }
        if !self.assumed.is_empty() {
            line(out, "assumed", &self.assumed.join("; "))?;
        }
        line(out, "effective_low", &self.effective_range.low.to_string())?;
        line(
            out,
            "effective_high",
            &self.effective_range.high.to_string(),
        )?;
        let declared = self.geometry.as_ref();
        if let Some(geometry) = declared.filter(|geometry| geometry.basis == Basis::Declared) {
            if let Some(frame) = &geometry.frame {
                line(out, "frame", frame)?;
            }
            // Columns are numbered from 1, so the name of a frame is not enough if motor numbers have gaps.
            let in_turn = (1..).zip(&self.motors).all(|(n, motor)| n == motor.number);
            if geometry.frame.is_none() || !in_turn {
                for (number, [roll, pitch, yaw]) in (1..).zip(&geometry.factors) {
                    let key = format!("motor{number}_factors");
                    line(out, &key, &format!("{roll} {pitch} {yaw}"))?;
                }
            }
        }
        // There may be more columns than the vehicle has motors, because spare outputs in a log may have motor functions.
        let columns = self.motors.len();
        if let Some(motors) = self
            .vehicle
            .motors
            .filter(|all| usize::from(*all) >= columns)
        {
            line(out, "motors", &motors.to_string())?;
        }
        if self
            .armed
            .as_ref()
            .is_some_and(|armed| armed.spans.is_empty())
        {
            line(out, "armed", "never")?;
        }
        if self.in_air.as_ref().is_some_and(|in_air| in_air.is_assumed) {
            line(out, "in_air", "assumed")?;
        }
        let spans = self.in_air.iter().flat_map(|in_air| &in_air.spans);
        if let Some(span) = spans.last().filter(|span| span.ends_with_log) {
            line(out, "end_s", &span.end_s.to_string())?;
        }
        if !self.rebooted_in_air_s.is_empty() {
            let times: Vec<String> = self.rebooted_in_air_s.iter().map(f64::to_string).collect();
            line(out, "rebooted_in_air_s", &times.join(" "))?;
        }
        if let Some(utc_s) = self.utc_at_zero_s {
            line(out, "utc_at_zero_s", &utc_s.to_string())?;
        }
        line(out, "written_by", WRITER)?;
        for (number, motor) in (1..).zip(&self.motors) {
            let output = format!("{} ({})", motor.output, motor.source);
            line(out, &format!("motor{number}_from"), &output)?;
        }
        for (key, value) in &self.header {
            if !known.contains(key) {
                writeln!(out, "# {}: {}", comment(key), comment(value))?;
            }
        }
        Ok(())
    }
}

fn cell(out: &mut dyn Write, value: Option<f64>) -> io::Result<()> {
    match value {
        Some(value) => write!(out, ",{value}"),
        None => write!(out, ","),
    }
}

/// The first characters that make a spreadsheet interpret a cell as a formula.
const FORMULA: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];

/// A text for a comment line. Line breaks, which would end the comment, are replaced. Spreadsheets split comments into
/// cells, so each cell is escaped.
fn comment(text: &str) -> String {
    let mut written = String::with_capacity(text.len());
    for (i, cell) in text.split_inclusive([',', ';']).enumerate() {
        let number = cell.trim_end_matches([',', ';']).trim().parse::<f64>();
        if i > 0 && cell.starts_with(FORMULA) && number.is_err() {
            written.push('\'');
        }
        written += cell;
    }
    written.replace(['\r', '\n'], " ")
}

/// A name as a cell, quoted if it contains characters that would end the cell.
fn quoted(name: &str) -> String {
    let name = match name.starts_with(FORMULA) {
        true => &format!("'{name}"),
        false => name,
    };
    match name.contains([',', '"', '\r', '\n']) {
        true => format!("\"{}\"", name.replace('"', "\"\"")),
        false => name.into(),
    }
}
