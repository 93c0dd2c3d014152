//! Benchmarks of the time and allocations of single evaluations, batches, maps and tables.

use divan::{Bencher, black_box, counter::ItemsCount};
use flagred_benches::{four_inputs, points, published, published_type2, tipper};
use fuzzy::engine::Interval;
use fuzzy::engine::{Engine, Outcome};
use fuzzy::map::{DecisionMap, Grid};
use fuzzy::model::{Model, TypeReduction};

#[global_allocator]
static ALLOCATOR: divan::AllocProfiler = divan::AllocProfiler::system();

fn main() {
    divan::main();
}

const POINTS: usize = 1024;

/// Evaluates 1024 points, one per call. The measured time is for all calls together; the throughput counts evaluations.
fn single(bencher: Bencher<'_, '_>, model: &Model) {
    let engine = Engine::new(model).unwrap();
    let mut scratch = engine.scratch();
    let points = points(model, POINTS);
    let mut outcomes = vec![Outcome::default(); engine.output_names().len()];
    bencher.counter(ItemsCount::new(POINTS)).bench_local(|| {
        for point in &points {
            engine
                .evaluate_with(&mut scratch, black_box(point), &mut outcomes)
                .unwrap();
            black_box(&outcomes);
        }
    });
}

#[divan::bench]
fn single_a_tipper(bencher: Bencher<'_, '_>) {
    single(bencher, &tipper());
}

#[divan::bench]
fn single_b_published(bencher: Bencher<'_, '_>) {
    single(bencher, &published(false));
}

#[divan::bench]
fn single_bw_published_weighted(bencher: Bencher<'_, '_>) {
    single(bencher, &published(true));
}

#[divan::bench]
fn single_b2_published_type2(bencher: Bencher<'_, '_>) {
    single(bencher, &published_type2());
}

#[divan::bench]
fn single_b2_published_nie_tan(bencher: Bencher<'_, '_>) {
    let mut model = published_type2();
    for output in &mut model.outputs {
        output.type_reduction = TypeReduction::NieTan;
    }
    single(bencher, &model);
}

#[divan::bench]
fn single_c_four_inputs(bencher: Bencher<'_, '_>) {
    single(bencher, &four_inputs());
}

/// Evaluates the rule set at 16 points with an interval around the value of each input. Each interval is a twentieth of
/// the input's range wide.
#[divan::bench]
fn intervals_b_published(bencher: Bencher<'_, '_>) {
    let engine = Engine::new(&published(false)).unwrap();
    let enclosure = engine.enclosure();
    let points = points(engine.model(), 16);
    let at = |point: &Vec<f64>| -> Vec<Interval> {
        let inputs = point.iter().zip(&engine.model().inputs);
        inputs
            .map(|(value, input)| Interval::around(*value, 0.025 * (input.high - input.low)))
            .collect()
    };
    let points: Vec<Vec<Interval>> = points.iter().map(at).collect();
    bencher.counter(ItemsCount::new(16_u32)).bench_local(|| {
        for point in &points {
            black_box(enclosure.evaluate(black_box(point)).unwrap());
        }
    });
}

/// Evaluates 65536 rows in one call, on one thread.
fn batch(bencher: Bencher<'_, '_>, model: &Model) {
    const ROWS: usize = 65_536;
    let engine = Engine::new(model).unwrap();
    let points = points(model, ROWS);
    let columns: Vec<Vec<f64>> = (0..model.inputs.len())
        .map(|input| points.iter().map(|point| point[input]).collect())
        .collect();
    let columns: Vec<&[f64]> = columns.iter().map(|column| &**column).collect();
    let mut outcomes = vec![Outcome::default(); ROWS];
    bencher.counter(ItemsCount::new(ROWS)).bench_local(|| {
        engine
            .evaluate_batch_into(black_box(&columns), &mut outcomes)
            .unwrap();
        black_box(&outcomes);
    });
}

#[divan::bench]
fn batch_a_tipper(bencher: Bencher<'_, '_>) {
    batch(bencher, &tipper());
}

#[divan::bench]
fn batch_bw_published_weighted(bencher: Bencher<'_, '_>) {
    batch(bencher, &published(true));
}

#[divan::bench]
fn batch_c_four_inputs(bencher: Bencher<'_, '_>) {
    batch(bencher, &four_inputs());
}

#[divan::bench]
fn map_501_by_501(bencher: Bencher<'_, '_>) {
    let engine = Engine::new(&published(true)).unwrap();
    let grid = Grid::new(&engine, 501).unwrap();
    bencher
        .counter(ItemsCount::new(grid.cells()))
        .bench_local(|| DecisionMap::new(&engine, grid.clone(), 0).unwrap());
}
