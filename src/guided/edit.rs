//! Trees that can be edited.

use super::endpoint::StageView;
use super::fork::Parts;
use super::graph::Graph;
use super::repair::{Asked, Entry, Origins};
use super::run::Terms;
use super::search::{Guide, NONE, Search, SearchError};
use super::synth::{Growth, Stage, SynthesisError, TreeSynth};
use crate::observer::{Observer, Work, report};
use crate::parameter::ParameterError;
use crate::shape::Bounds;
use std::sync::Arc;

/// The trees of one seed in a graph, with the search of each stage, so that they can follow an edit of the pipeline
/// faster than by growing anew: an endpoint, a shape or an obstacle that moves, another rule.
///
/// A stage's search is brought up to date where its tree, its rule or its weights have changed; its endpoints are chosen
/// again if anything it sees has changed. The trees are those of [`TreeSynth::grow_all`], to the bit. The
/// amount that is searched anew depends on how far the change reaches: all paths from a place that has
/// changed, and all that are better now.
///
/// Results depend on what a rule or a weight asks for. One that asks for [`Fork`](super::Fork)s
/// sees every fork whose tips or length have changed, so that mostly everything is searched anew.
/// [`Apart`](super::Apart) asks what lies beside the tree, which changes little.
///
/// The edited tree keeps as much as its endpoints do. Endpoints that nodes draw for themselves stay
/// wherever nothing has changed: [`Count::Each`](super::Count::Each) of a whole surface. A
/// [share](super::Count::Share) or a count, and the
/// [outermost fraction](super::HopSurface::with_outermost), are chosen among all candidates, so that some
/// change far away too.
///
/// Memory: 36 bytes per node and stage, 4 bytes per edge. Stages that [refine](super::Refinement) are
/// refused: their graph is another one after every edit.
///
/// ```
/// use treesynth::{Silent, glam::Vec3};
/// use treesynth::guided::{Bend, HopSurface, InShape, NearestTo, PoissonYao, Regrowth, Search, Stage, TreeSynth};
/// use treesynth::shape::{Cuboid, Ellipsoid};
///
/// let region = Cuboid::new(Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 6.0, 3.0));
/// let crown = |x| Ellipsoid::new(Vec3::new(x, 3.8, 0.0), Vec3::splat(1.8));
/// let limbs = |x| InShape::poisson_disc(crown(x), 40);
/// let synth = TreeSynth::new(PoissonYao::new(region).with_nodes(10_000))
///     .stage(Stage::new(Bend::none(), NearestTo::new(Vec3::Y * 4.5)))
///     .stage(Stage::new(Bend::piecewise(1.0, 0.0, 1), limbs(0.0)))
///     .stage(Stage::new(Bend::piecewise(0.5, 0.0, 1), HopSurface::new(2, 200)));
/// let graph = synth.build_graph(7, &Silent)?;
/// let mut tree = Regrowth::new(&synth, &graph, 7, &Silent)?;
///
/// // The crown moves to the side.
/// let mut stages = synth.stages().to_vec();
/// stages[1] = stages[1].clone().with_endpoints(limbs(0.2));
/// let edited = synth.with_stages(stages);
/// tree.regrow(&edited, &[], &Silent)?;
/// assert_eq!(tree.trees(), edited.grow_all(&mut Search::new(&graph), 7, &Silent)?);
/// # Ok::<(), treesynth::SynthesisError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Regrowth<'g> {
    graph: &'g Graph,
    seed: u64,
    stages: Vec<Stage>,
    searches: Vec<Searched<'g>>,
    origins: Origins,
    /// The trees that stages begin with.
    bare: Search<'g>,
    trees: Vec<Growth>,
    anew: usize,
    /// One bit per node, all of them off between uses.
    joined: Vec<u64>,
}

/// A stage's search, complete, and what came of it.
#[derive(Debug, Clone)]
struct Searched<'g> {
    search: Search<'g>,
    /// The trees before the stage.
    entries: Vec<Entry>,
    endpoints: Vec<u32>,
    asked: Asked,
}

impl<'g> Regrowth<'g> {
    /// Grows the trees of `seed` in `graph`, and keeps the searches. They go to their ends, which takes somewhat longer
    /// than [`TreeSynth::grow_all`].
    ///
    /// # Errors
    /// As `grow_all`, and a parameter error for a stage that refines.
    pub fn new(
        synth: &TreeSynth,
        graph: &'g Graph,
        seed: u64,
        observer: &dyn Observer,
    ) -> Result<Self, SynthesisError> {
        let mut regrowth = Self {
            graph,
            seed,
            stages: Vec::new(),
            searches: Vec::new(),
            origins: Origins::of(graph),
            bare: Search::new(graph),
            trees: Vec::new(),
            anew: 0,
            joined: vec![0; graph.nodes().div_ceil(64)],
        };
        regrowth.regrow(synth, &[], observer)?;
        Ok(regrowth)
    }

    /// The trees, in the order of the graph's roots.
    pub fn trees(&self) -> &[Growth] {
        &self.trees
    }

    /// The search of a stage, which went to its end: costs, paths and vectors, and the trees before the stage.
    pub fn search(&self, stage: usize) -> Option<&Search<'g>> {
        self.searches.get(stage).map(|searched| &searched.search)
    }

    /// Nodes that the latest change searched anew, those of all stages together.
    pub fn searched_anew(&self) -> usize {
        self.anew
    }

    /// The trees of an edited pipeline. Strategies that it shares with the one before, as clones do, are unchanged.
    ///
    /// Rules and weights that it does not share may differ inside of the boxes `changed`; everywhere else they give what
    /// those before gave, or the trees will not be those of `grow_all`. For an obstacle that moves these are the bounds of
    /// where it was and of where it is. Without boxes they may differ everywhere, and their stage is
    /// searched from nothing. Endpoint policies, shedding and radii may differ in any way; the graph of `synth` is not
    /// asked.
    ///
    /// # Errors
    /// As `grow_all`, and a parameter error for a stage that refines. The trees are then what they were, and
    /// the next change starts from nothing.
    pub fn regrow(
        &mut self,
        synth: &TreeSynth,
        changed: &[Bounds],
        observer: &dyn Observer,
    ) -> Result<(), SynthesisError> {
        synth.check_growth()?;
        let refines = synth.refines();
        ParameterError::unless(
            !refines,
            "Stage.refinement",
            refines,
            "none; without_refinements takes it away",
        )?;
        let result = self.follow(synth, changed, observer);
        if result.is_err() {
            // Some searches are the new pipeline's, some the old one's.
            self.stages.clear();
            self.searches.clear();
        }
        result
    }

    fn follow(
        &mut self,
        synth: &TreeSynth,
        changed: &[Bounds],
        observer: &dyn Observer,
    ) -> Result<(), SynthesisError> {
        let stages = synth.stages();
        let mut entries = self.bare.entries();
        let mut anew = 0;
        for (number, stage) in stages.iter().enumerate() {
            let terms = Terms {
                rule: &*stage.rule,
                weight: &*stage.weight,
                stage: number,
                stages: stages.len(),
                seed: self.seed,
                observer,
            };
            report(observer, Work::Stage { index: number, of: stages.len() }, 0.0)?;
            let before = self.stages.get(number);
            let is_same = before.is_some_and(|old| {
                Arc::ptr_eq(&old.rule, &stage.rule) && Arc::ptr_eq(&old.weight, &stage.weight)
            });
            let asks_anew = before.is_none_or(|old| !Arc::ptr_eq(&old.endpoints, &stage.endpoints));
            let boxes = if is_same { &[] } else { changed };
            let is_new = number >= self.searches.len();
            if is_new {
                let (search, asked) = (self.bare.clone(), Asked::default());
                self.searches.push(Searched { search, entries: Vec::new(), endpoints: Vec::new(), asked });
            }
            let searched = &mut self.searches[number];
            let stays = !is_new && is_same && searched.entries == entries;
            if !stays {
                let can_repair = !is_new && (is_same || !changed.is_empty());
                let Searched { search, asked, .. } = searched;
                let repaired = if can_repair {
                    search.repair(&entries, boxes, asked, &self.origins, &terms)?
                } else {
                    None
                };
                if let Some(nodes) = repaired {
                    anew += nodes;
                } else {
                    search.install(&entries);
                    search.forget();
                    search.run(&terms, None)?;
                    *asked = Asked::by(search);
                    anew += self.graph.nodes();
                }
                searched.entries = entries;
            }
            if !stays || asks_anew {
                let view = StageView::new(&searched.search, number, self.seed);
                let chosen = stage.endpoints.select(&view);
                searched.endpoints =
                    chosen.map_err(|error| SynthesisError::Endpoints { stage: number, error })?;
            }
            entries = extended(searched, number, &mut self.joined)?;
        }
        self.searches.truncate(stages.len());
        self.stages = stages.to_vec();
        let endpoints: Vec<Vec<u32>> =
            self.searches.iter().map(|searched| searched.endpoints.clone()).collect();
        let tree: Vec<u32> = entries.iter().map(|entry| entry.node).collect();
        let skeletons = self.parts(&entries).skeletons()?;
        self.trees = synth.finish(skeletons, &tree, &endpoints, None, observer)?;
        self.anew = anew;
        Ok(())
    }

    fn parts(&self, entries: &[Entry]) -> Parts<'_> {
        let mut places = vec![NONE; self.graph.nodes()];
        for (place, entry) in (0..).zip(entries) {
            places[entry.node as usize] = place;
        }
        let parent = |entry: &Entry| (entry.parent != NONE).then(|| places[entry.parent as usize]);
        Parts {
            positions: entries.iter().map(|entry| self.graph.position(entry.node)).collect(),
            parents: entries.iter().map(parent).collect(),
            stages: entries.iter().map(|entry| entry.stage).collect(),
            hops: entries.iter().map(|entry| entry.guide.hops).collect(),
            radii: &self.bare.radii,
        }
    }
}

/// The trees after a stage, as [`Search::extend`] makes them.
fn extended(searched: &Searched<'_>, stage: usize, joined: &mut [u64]) -> Result<Vec<Entry>, SearchError> {
    let Searched { search, endpoints, .. } = searched;
    search.check_endpoints(endpoints, stage)?;
    let mut entries = search.entries();
    let old = entries.len();
    let joins = search.joining(stage);
    let mut path = Vec::new();
    for &endpoint in endpoints {
        let mut node = endpoint;
        while !search.is_on_tree(node) && joined[node as usize / 64] >> (node % 64) & 1 == 0 {
            joined[node as usize / 64] |= 1 << (node % 64);
            path.push(node);
            node = search.parents[node as usize];
        }
        while let Some(node) = path.pop() {
            let guide = search.guides[node as usize];
            let parent = search.parents[node as usize];
            let guide = Guide { source: node, ..guide };
            entries.push(Entry { node, parent, stage: joins, guide });
        }
    }
    entries[old..].iter().for_each(|entry| joined[entry.node as usize / 64] = 0);
    Ok(entries)
}
