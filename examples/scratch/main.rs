use std::time::Instant;
use treesynth::glam::Vec3;
use treesynth::self_organizing::*;
fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(std::env::args().nth(1).map_or(1, |s| s.parse().unwrap())).build_global().unwrap();
    let b: f32 = std::env::args().nth(2).map_or(1.5, |s| s.parse().unwrap());
    let span: f32 = std::env::args().nth(3).map_or(3.2, |s| s.parse().unwrap());
    let dark: Option<f32> = std::env::args().nth(4).map(|s| s.parse().unwrap());
    let bench = |n: i32, seasons: u32, seed: u64, verbose: bool| {
        let start = Instant::now();
        let mut f = Forest::new(ShadowPropagation::default().with_falloff(b).with_darkest(dark), Habit::default(), seed);
        for i in 0..n { for j in 0..n {
            let at = |i: i32| if n == 1 { 0.0 } else { span * ((i as f32) / (n - 1) as f32 - 0.5) };
            f.plant(Vec3::new(at(i), 0.0, at(j))).unwrap();
        }}
        for s in 0..seasons {
            f.step().unwrap();
            if verbose { print!("{}:{} ", s + 1, f.metamers()); }
        }
        let t = start.elapsed();
        let top = f.trees().iter().flat_map(|t| t.positions()).map(|p| p.y).fold(0.0, f32::max);
        let ever: u64 = f.trees().iter().map(|t| t.created() as u64).sum();
        println!("seed {seed} trees {} metamers {} {:?} top {top} ever {ever}", f.trees().len(), f.metamers(), t);
    };
    bench(1, 20, 1, true);
    for seed in 1..6 { bench(1, 20, seed, false); }
    bench(5, 21, 1, true);
}
