//! Benchmarks of the time and memory of learning rules and of filling the gaps of a map, at the size of a large data
//! set: 100,000 rows of four inputs with five terms each, and a map with 51 cells along each of four inputs (6.8
//! million cells).

use divan::{Bencher, black_box, counter::ItemsCount};
use flagred::gap::{FilledMap, Filling, GapMethod, GapSettings};
use flagred_benches::{four_inputs, points};
use flagred_evaluation::learning::{Row, cross_validate};
use fuzzy::{
    Engine, Model,
    learn::{Learner, Settings},
    map::{DecisionMap, Grid},
};

#[global_allocator]
static ALLOCATOR: divan::AllocProfiler = divan::AllocProfiler::system();

fn main() {
    divan::main();
}

const ROWS: usize = 100_000;

/// Returns a rule set without its rules, and rows that are spread evenly over the ranges of its inputs. The last value
/// of each row is the output of the complete rule set.
fn rows() -> (Model, Vec<Row>) {
    let model = four_inputs();
    let engine = Engine::new(&model).unwrap();
    let rows = points(&model, ROWS).into_iter().map(|mut values| {
        let output = engine.evaluate(&values).unwrap()[0].value().unwrap();
        values.push(output);
        Row {
            values,
            weight: 1.0,
            group: None,
        }
    });
    let rows = rows.collect();
    let mut blank = model;
    blank.rules.clear();
    (blank, rows)
}

#[divan::bench(sample_count = 10)]
fn learn_100_000_rows(bencher: Bencher<'_, '_>) {
    let (model, rows) = rows();
    bencher.counter(ItemsCount::new(ROWS)).bench_local(|| {
        let mut learner = Learner::new(&model, Settings::default()).unwrap();
        for row in &rows {
            learner.add(black_box(&row.values), row.weight).unwrap();
        }
        learner.finish()
    });
}

#[divan::bench(sample_count = 3)]
fn cross_validate_100_000_rows_ten_times(bencher: Bencher<'_, '_>) {
    let (model, rows) = rows();
    bencher.counter(ItemsCount::new(ROWS)).bench_local(|| {
        cross_validate(
            &model,
            &Settings::default(),
            &GapSettings::default(),
            black_box(&rows),
        )
    });
}

/// Evaluates and fills the map of a rule set in which every third rule is missing, and reads each cell.
#[divan::bench(sample_count = 1, args = [GapMethod::Nearest, GapMethod::INVERSE_DISTANCE, GapMethod::ThinPlate, GapMethod::Harmonic])]
fn fill_a_map_of_51_to_the_4(bencher: Bencher<'_, '_>, method: GapMethod) {
    let mut model = four_inputs();
    let mut place = 0;
    model.rules.retain(|_| {
        place += 1;
        place % 3 != 0
    });
    let engine = Engine::new(&model).unwrap();
    let mut settings = GapSettings::default();
    settings.method = method;
    bencher
        .counter(ItemsCount::new(51usize.pow(4)))
        .bench_local(|| {
            let grid = Grid::new(&engine, 51).unwrap();
            let map = DecisionMap::new(&engine, grid, 0).unwrap();
            let filling = Filling::new(&engine, &model, 0, &settings).unwrap();
            let filled = FilledMap::new(map, filling);
            let cells = 0..filled.map().grid().cells();
            assert!(filled.filled_share() > 0.0);
            cells.map(|cell| filled.value(cell).unwrap()).sum::<f64>()
        });
}
