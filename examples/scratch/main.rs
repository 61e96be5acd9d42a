//! scratch
use std::time::Instant;
use treesynth::glam::Vec3;
use treesynth::self_organizing::*;
fn main() {
    let arg = |i: usize, d: f32| std::env::args().nth(i).map_or(d, |s| s.parse().unwrap());
    rayon::ThreadPoolBuilder::new().num_threads(arg(1, 1.0) as usize).build_global().unwrap();
    let (n, seasons, b, span, reps) = (arg(2, 1.0) as i32, arg(3, 20.0) as u32, arg(4, 1.2247449), arg(5, 2.56), arg(6, 5.0) as u64);
    let mut best = f64::MAX;
    let mut sum = 0;
    for seed in 0..reps {
        let start = Instant::now();
        let mut f = Forest::new(ShadowPropagation::default().with_falloff(b), Habit::default(), if n == 1 { seed } else { 1 });
        for i in 0..n { for j in 0..n {
            let at = |i: i32| if n == 1 { 0.0 } else { span * ((i as f32) / (n - 1) as f32 - 0.5) };
            f.plant(Vec3::new(at(i), 0.0, at(j))).unwrap();
        }}
        f.grow(seasons).unwrap();
        let t = start.elapsed().as_secs_f64();
        best = best.min(t * 1e9 / f.metamers() as f64);
        sum += f.metamers();
    }
    println!("n {n} mean metamers {} best ns/metamer {best:.0}", sum as u64 / reps);
}
