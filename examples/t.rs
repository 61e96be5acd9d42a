use treesynth::{*, guided::*, glam::Vec3, shape::Cuboid};
fn main(){
 let n: usize = std::env::args().nth(1).map(|s|s.parse().unwrap()).unwrap_or(150000);
 for seed in 0..3 {
 let t=std::time::Instant::now();
 let nodes=std::sync::Mutex::new(0.0);
 let obs=|p: Progress|{ if p.work==Work::Nodes && p.fraction==1.0 {*nodes.lock().unwrap()=t.elapsed().as_secs_f64();} std::ops::ControlFlow::Continue(())};
 let b=PoissonYao::new(Cuboid::new(Vec3::new(-1.0,0.0,-1.0),Vec3::new(1.0,2.0,1.0))).with_nodes(n);
 let r=b.spacing().unwrap();
 let g=b.build(seed,&obs).unwrap();
 let a=*nodes.lock().unwrap();
 println!("{} nodes {} edges nodes {:.1} ms edges {:.1} ms  n r^3/V {:.4}", g.nodes(), g.edges(), a*1e3, (t.elapsed().as_secs_f64()-a)*1e3, g.nodes() as f32*r*r*r/8.0);
 }
 let b=PoissonYao::new(Cuboid::new(Vec3::new(-1.0,0.0,-1.0),Vec3::new(1.0,2.0,1.0))).with_nodes(n).planar();
 let r=b.spacing().unwrap();
 let g=b.build(1,&Silent).unwrap();
 println!("planar {} {:.4}", g.nodes(), g.nodes() as f32*r*r/4.0);
}
