//! Replays a log over MAVLink, to try `flagred watch` without a vehicle or a simulator:
//! `cargo run -p flagred-tests --example fly_a_log -- LOG ADDRESS:PORT`.

use std::{env, error::Error, process::ExitCode};

use flagred_flightlog::mavlink::Version;
use flagred_tests::{
    vehicle::{StandIn, flight},
    wire::{Link, Speed, Wire},
};

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [log, address] = arguments.as_slice() else {
        eprintln!("usage: fly_a_log LOG ADDRESS:PORT");
        return Ok(ExitCode::from(2));
    };
    let flight = flight(log.as_ref());
    let wire = Wire::udp(address.parse()?);
    let mut vehicle = StandIn::new(&flight, wire, Link::default(), Version::V2);
    vehicle.meet();
    vehicle.fly(&flight, Speed::Times(1.0), 0.0, f64::INFINITY);
    Ok(ExitCode::SUCCESS)
}
