use treesynth::{Silent, glam::Vec3, preview::Preview, radius::*, shape::*, surface::Tubes, variational::*};
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let a: Vec<f32> = std::env::args().skip(1).map(|x| x.parse().unwrap()).collect();
    let n = a[0] as usize;
    let crown = HalfEllipsoid::new(Vec3::Y * 2.5, Vec3::new(3.5, 7.0, 3.5));
    let t = std::time::Instant::now();
    let shape =
        GuidanceShape::on_surface(&crown, n / 2, 1)?.joined(&GuidanceShape::in_volume(&crown, n - n / 2, 2)?);
    println!("shape {:?} d {:?}", t.elapsed(), shape.diameters()[0]);
    let l = |m, p: f32, th: f32| {
        Level::default().with_metamers(m).with_apical_control(p).with_angle(th.to_radians())
    };
    let synth = VariationalSynth::new(shape)
        .with_levels([l(a[3] as u32, a[4], a[5]), l(5, 0.8, a[5]), l(5, 0.8, a[5])])
        .with_weights(a[1], a[2])
        .with_refinements(a[6] as u32, a[7] as u32)
        .with_radius(PipeModel::default().with_exponent(2.5).with_trunk_diameter(0.35));
    let t = std::time::Instant::now();
    let growth = synth.grow(1, &Silent)?;
    println!(
        "grown {:?} segments {} branch nodes {}",
        t.elapsed(),
        growth.skeleton.segments(),
        growth.branch_nodes
    );
    for s in &growth.trace {
        println!(
            "{:?} F {:.5} FI {:.5} FE {:.4} FP {:.1} n {}",
            s.kind, s.total, s.structure, s.guidance, s.penalty, s.branch_nodes
        );
    }
    println!("best {}", growth.best);
    let mesh = Tubes::default().mesh(&growth.skeleton)?;
    let pic = Preview::default().with_size(900, 900).draw(&mesh)?;
    pic.write_png(std::fs::File::create("/tmp/v.png")?)?;
    Ok(())
}
