//! The outputs of SERVO_OUTPUT_RAW: port 0 has the outputs 1 to 16, port 1 the outputs 17 to 32.

use crate::{Motor, parameters::Parameters, px4};

/// The number of outputs of a port.
pub(crate) const OUTPUTS_PER_PORT: usize = 16;

/// The port of an output (numbered from 1), and the index of the output in that port. The ports of PX4 are its banks:
/// 0 is MAIN, 1 is AUX.
pub(crate) fn bank(output: u16) -> (u8, usize) {
    let index = usize::from(output.saturating_sub(1));
    let port = u8::try_from(index / OUTPUTS_PER_PORT).unwrap_or(u8::MAX);
    (port, index % OUTPUTS_PER_PORT)
}

/// The name of the message field of an output.
pub(crate) fn field(output: u16) -> String {
    match bank(output) {
        (0, index) => format!("servo{}_raw", index + 1),
        (port, index) => format!("servo{}_raw of port {port}", index + 1),
    }
}

/// The motors that PX4's PWM_MAIN_FUNCn and PWM_AUX_FUNCn name, with the output of each; none before 1.13.
pub(crate) fn px4_motors(parameters: &Parameters) -> Vec<(Motor, u16)> {
    let of_bank = |bank: u8| {
        let motors = px4::actuator_outputs(parameters, bank, None).into_iter();
        motors.map(move |(motor, index)| {
            let output = (OUTPUTS_PER_PORT * usize::from(bank) + index + 1) as u16;
            let named = Motor {
                output: field(output),
                ..motor
            };
            (named, output)
        })
    };
    let mut motors: Vec<_> = of_bank(0).chain(of_bank(1)).collect();
    motors.sort_by_key(|(motor, output)| (motor.number, *output));
    motors
}
