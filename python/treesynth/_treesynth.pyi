"""Contents of the extension module. Arrays are views without a copy where "view" is said; views are read-only.

``TreesynthError`` is raised for requests that cannot be met, with a text that names the parameter, its value and its range; ``OSError`` for
files. ``progress`` is called about twenty times a second as ``progress(what, fraction)``, from the thread that called; what it
raises stops the work, as Ctrl-C does. Other threads of Python go on while the library works.
"""

from os import PathLike
from typing import Any, Callable, Literal, Sequence, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

Path = str | PathLike[str]
Progress = Callable[[str, float], object]
Point = Sequence[float]
Up = Literal["y", "z"]
Images = Literal["jpeg", "png"]
System = Literal["species", "guided", "self-organizing", "variational", "growth"]

__version__: str

class TreesynthError(ValueError):
    """A request that cannot be met; the text names the parameter, its value and its range."""

class _Name(TypedDict, total=False):
    name: str
    system: System
    about: str
    latin: str

class Skeleton:
    """A tree's nodes, each after its parent. Compares by value; can be pickled."""

    def __init__(
        self,
        positions: ArrayLike,
        parents: ArrayLike,
        radii: ArrayLike | None = None,
        *,
        orders: ArrayLike | None = None,
        stages: ArrayLike | None = None,
        hops: ArrayLike | None = None,
    ) -> None:
        """Positions ``(n, 3)`` in metres, +Y up; a parent's number for each node, smaller than its own, -1 for the root, which
        comes first; radii in metres. What is left out is worked out; radii are then 0."""

    @property
    def positions(self) -> NDArray[np.float32]:
        """Places of the nodes, metres, ``(n, 3)``: a view."""

    @property
    def parents(self) -> NDArray[np.int64]:
        """The parent of each node, -1 for the root, ``(n,)``: a view."""

    @property
    def radii(self) -> NDArray[np.float32]:
        """Radii at the nodes, metres, ``(n,)``: a view."""

    @property
    def orders(self) -> NDArray[np.uint16]:
        """Branching order of each node, 0 for the trunk, ``(n,)``: a view."""

    @property
    def stages(self) -> NDArray[np.uint16]:
        """The stage in which each node grew, ``(n,)``: a view. Of species its rank: 0 stems, 1 limbs, 2 branches, 3 twigs, 4 shoots."""

    @property
    def hops(self) -> NDArray[np.uint32]:
        """Hops from the source of its stage in guided trees: 1 at the first node off the tree; else 0. ``(n,)``: a view."""

    def metrics(self) -> dict[str, Any]:
        """Measures of the tree, as `treesynth::Metrics` of the Rust library documents them. Lengths in metres."""

    def diameter_at(self, height: float) -> float | None:
        """Diameter of the stem at a height above the base, metres; none above its tip. 1.3 gives DBH."""

    def relaxed(self, share: float = 0.5, passes: int = 3) -> Skeleton:
        """With nodes drawn `share` (0 to 1) of the way between their neighbours, `passes` times."""

    def mesh(self, sides: int = 8, *, progress: Progress | None = None) -> Mesh:
        """Tubes along the branches; `sides` (3 to 64) per ring of the thickest."""

    def closed_mesh(self, detail: float = 1.0, *, progress: Progress | None = None) -> Mesh:
        """One closed surface without self-intersections, for printers; `detail` (0.867 to 64) is voxels per radius."""

    def save(self, path: Path, *, up: Up = "z", unit: float = 1.0, offset: Point | None = None) -> None:
        """To .json or .svg (metres, +Y up), .swc, .csv or .qsm (a QSM table) or .mtg. `unit` is metres per unit of the file,
        `offset` is added to its coordinates."""

    def __len__(self) -> int: ...

class Mesh:
    """Triangles."""

    @property
    def name(self) -> str: ...
    @property
    def positions(self) -> NDArray[np.float32]:
        """Metres, ``(n, 3)``: a view."""

    @property
    def normals(self) -> NDArray[np.float32]:
        """Unit normals, ``(n, 3)``: a view."""

    @property
    def uvs(self) -> NDArray[np.float32]:
        """Texture coordinates, ``(n, 2)``, or ``(0, 2)``: a view."""

    @property
    def colors(self) -> NDArray[np.float32]:
        """Factors on the colour, linear red, green and blue, ``(n, 3)``, or ``(0, 3)``: a view."""

    @property
    def triangles(self) -> NDArray[np.uint32]:
        """Vertices of each triangle, counter-clockwise from outside, ``(m, 3)``: a view."""

class Leaves:
    """Leaves of one kind and tone, or blossom, catkins, fruit, cones: one mesh in many places."""

    @property
    def mesh(self) -> Mesh: ...
    @property
    def matrices(self) -> NDArray[np.float32]:
        """Transform of each copy of the mesh, ``(n, 4, 4)``, for columns of points."""

    @property
    def nodes(self) -> NDArray[np.uint32]:
        """The node of the skeleton that bears each, ``(n,)``."""

    @property
    def tints(self) -> NDArray[np.float32]:
        """Factors on the colour of each, linear, ``(n, 3)``."""

    @property
    def area(self) -> float:
        """Area of all of them, one side, square metres."""

    def __len__(self) -> int: ...

class Tree:
    """A grown tree: skeleton, leaves, bark."""

    @property
    def name(self) -> str: ...
    @property
    def seed(self) -> int: ...
    @property
    def skeleton(self) -> Skeleton: ...
    @property
    def leaves(self) -> list[Leaves]: ...
    @property
    def numbers(self) -> dict[str, Any]:
        """Numbers of the tree: of species height, dbh, age, crown_width, crown_base, leaf_area, ..."""

    def asset(
        self,
        triangles: int | None = 20_000,
        *,
        textures: int | None = 512,
        levels: int = 1,
        wind: bool = False,
        progress: Progress | None = None,
    ) -> Asset:
        """A model of at most `triangles`, or the dense one for None. `textures` is the side of the images, a power of two
        from 128 to 8192, or None for plain colours. With `levels` of 2 to 8, each has 0.3 of the triangles of the one before, and
        an impostor follows. With `wind` vertices carry what a shader needs to move them."""

    def save(
        self,
        path: Path,
        triangles: int | None = 20_000,
        *,
        textures: int | None = 512,
        levels: int = 1,
        wind: bool = False,
        up: Up = "y",
        unit: float = 1.0,
        images: Images = "png",
        progress: Progress | None = None,
    ) -> None:
        """`asset` and `Asset.save` in one call."""

class Asset:
    """A model: the finest level first."""

    @property
    def triangles(self) -> list[int]:
        """Triangles of each level."""

    @property
    def errors(self) -> list[float]:
        """Error of each level, metres: show it from where this is less than a pixel."""

    @property
    def height(self) -> float:
        """Height of the tree, metres."""

    def save(
        self,
        path: Path,
        *,
        up: Up = "y",
        unit: float = 1.0,
        quantize: bool = False,
        lod_names: bool = False,
        images: Images = "png",
    ) -> None:
        """To .glb (all levels, images inside), .usdz, .usda (all levels), or the finest level to .obj, .ply, .stl, or its picture
        to .png. A file appears whole or not at all. glTF is +Y up and metres always. `quantize` makes smaller GLB files;
        `lod_names` names levels NAME_LOD0, NAME_LOD1, ... for Godot, Unity and Unreal. With `images="jpeg"` images without alpha in
        GLB files are JPEG of quality 85, a fraction of the bytes; those with alpha stay PNG."""

    def picture(
        self,
        size: int = 800,
        *,
        azimuth: float = 0.0,
        elevation: float = 3.0,
        level: int = 0,
        transparent: bool = False,
    ) -> NDArray[np.uint8]:
        """Drawn without a GPU: ``(size, size, 3)``, or 4 with `transparent`. Angles in degrees."""

class Species:
    """A species: built in, or from a text as docs/species.md has it. Compares by value; can be pickled."""

    @staticmethod
    def named(name: str) -> Species:
        """The species of an English, Latin or other name."""

    @staticmethod
    def parse(text: str) -> Species:
        """From its text; an error names the line and the field."""

    def to_text(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def latin(self) -> str: ...
    @property
    def data(self) -> dict[str, Any]:
        """All parameters."""

    def grow(
        self,
        *,
        seed: int = 0,
        height: float | None = None,
        dbh: float | None = None,
        age: float | None = None,
        day: float | None = None,
        stand_spacing: float | None = None,
        years_dead: float | None = None,
        storm_damage: float | None = None,
    ) -> Tree:
        """A tree of this species, as `treesynth.grow`."""

class Recipe:
    """A pipeline of the guided system as data: graph, stages, shedding, radii, seed. Compares by value; can be pickled."""

    @staticmethod
    def preset(name: str, nodes: int = 150_000) -> Recipe:
        """The pipeline of a preset, on a graph of about `nodes` nodes."""

    @staticmethod
    def from_json(text: str) -> Recipe: ...
    @staticmethod
    def from_data(data: dict[str, Any]) -> Recipe:
        """A pipeline from the output of `data`, changed or not."""

    def to_json(self) -> str: ...
    @property
    def data(self) -> dict[str, Any]: ...
    @property
    def seed(self) -> int: ...
    def grow(self, seed: int | None = None, *, progress: Progress | None = None) -> Skeleton: ...

class Forest:
    """A stand of the self-organizing system, which grows season by season, tended after each if the stand has a gardener. Can be
    pickled, and goes on bit for bit."""

    def __init__(self, name: str, *, seed: int | None = None, most_metamers: int | None = None) -> None:
        """The stand of that name as it is planted; growth stops at `most_metamers`."""

    @staticmethod
    def from_json(name: str, text: str) -> Forest:
        """Goes on with a forest of this name that `to_json` has saved."""

    def to_json(self) -> str: ...
    @property
    def name(self) -> str: ...
    def grow(self, seasons: int = 1, *, progress: Progress | None = None) -> None:
        """Grows `seasons` more. All that has grown before an error or Ctrl-C is kept."""

    @property
    def season(self) -> int:
        """Seasons that have passed."""

    @property
    def metamers(self) -> int: ...
    @property
    def trees(self) -> list[Skeleton]:
        """All trees where they stand."""

    @property
    def places(self) -> NDArray[np.float32]:
        """The base of each tree, metres, ``(n, 3)``."""

class Growth:
    """One tree at all its ages, of the growth system."""

    def __init__(self, name: str, *, seed: int | None = None) -> None: ...
    @property
    def years(self) -> int:
        """Its greatest age."""

    def at(self, age: float, *, progress: Progress | None = None) -> Tree:
        """The tree at an age in years; fractions are days."""

class Landscape:
    """A planted landscape without end, of which any tile can be grown alone: in any order, on any process or machine, to the same bits.
    Trees stand in square cells, one each or none; a tile sees the trees within `margin` cells around it and nothing beyond. Can be
    pickled."""

    def __init__(
        self,
        species: Sequence[str | tuple[str, dict[str, Any]]],
        *,
        seed: int = 1,
        spacing: float = 2.0,
        scatter: float = 0.7,
        tile: int = 16,
        margin: int = 4,
        heights: ArrayLike | None = None,
        planting: ArrayLike | None = None,
        density: ArrayLike | None = None,
        corner: tuple[float, float] = (0.0, 0.0),
        step: float = 1.0,
    ) -> None:
        """`species` are names of stands, whose first tree's habit they have, or names of your own with a habit as data.
        `spacing` is the width of a cell in metres, `scatter` how far trees stray in theirs, 0 to 0.9; `tile` and `margin`
        count cells.

        Maps are arrays of rows along x, one row after the other in z, from `corner` (x and z) on, `step` metres
        apart: `heights` of the ground, metres, straight between; `planting`, the number of the species of each field, -1
        for none; `density`, the share of its cells that is planted, 0 to 1. Nothing is planted beyond the last two."""

    @staticmethod
    def from_json(text: str) -> Landscape:
        """The landscape that `to_json` has saved."""

    def to_json(self) -> str: ...
    @property
    def species(self) -> list[str]: ...
    @property
    def side(self) -> float:
        """Length of a side of a tile, metres."""

    def origin(self, x: int, z: int) -> tuple[float, float, float]:
        """Where the frame of a tile has its origin, metres."""

    def grow(self, x: int, z: int, seasons: int, *, progress: Progress | None = None) -> Tile:
        """The trees of a tile after so many seasons."""

class Tile:
    """The trees of one tile of a landscape, in the tile's frame."""

    @property
    def tile(self) -> tuple[int, int]: ...
    @property
    def origin(self) -> tuple[float, float, float]:
        """Place of the frame's origin in the landscape, metres."""

    @property
    def metamers(self) -> int:
        """Of its own trees."""

    @property
    def trees(self) -> list[Skeleton]: ...
    @property
    def places(self) -> NDArray[np.float64]:
        """The base of each tree in the landscape, metres, ``(n, 3)``."""

    def save_table(self, path: Path) -> None:
        """Writes a Parquet file with a row for each tree: place, species, age, height, diameter, crown and wood."""

    def save_models(
        self, near: Path, far: Path, *, error: float = 0.02
    ) -> tuple[list[list[float]], list[float]] | None:
        """Writes two GLB files of the trees in leaf: `near`, whose bark is off by at most `error` metres, and `far`, by eight times that; one leaf
        of two triangles stands for 12 and for 96. Returns the lowest and the highest corner of all, and the error of each file in metres, that of its bark or
        the length of its leaves; None, and no files, if there are no trees."""

class Cloud:
    """Points, +Y up and metres, 32 bits each, beside the offset taken off their coordinates. Compares by value."""

    def __init__(
        self, points: ArrayLike, *, up: Up = "z", unit: float = 1.0, offset: Point | None = None
    ) -> None:
        """Points ``(n, 3)``, 64 bits; `offset` is taken off, by default as large coordinates need it."""

    @staticmethod
    def open(path: Path, *, up: Up = "z", unit: float = 1.0, offset: Point | None = None) -> Cloud:
        """From a .ply, .las, .laz, .e57, .xyz, .txt, .asc or .pts file."""

    def save(self, path: Path, *, up: Up = "z", unit: float = 1.0, offset: Point | None = None) -> None: ...
    @property
    def points(self) -> NDArray[np.float32]:
        """Metres, +Y up, ``(n, 3)``: a view."""

    @property
    def offset(self) -> list[float]:
        """The offset taken off the coordinates, in the axes and unit of the array or file."""

    def thinned(self, side: float) -> Cloud:
        """One point in each cube with that side, metres."""

    def __len__(self) -> int: ...

class Scan:
    """Points measured by a simulated scanner."""

    @property
    def cloud(self) -> Cloud: ...
    @property
    def is_wood(self) -> NDArray[np.bool_]:
        """True for points on bark, ``(n,)``."""

    @property
    def is_ground(self) -> NDArray[np.bool_]: ...
    @property
    def nodes(self) -> NDArray[np.uint32]:
        """The node of the skeleton that each point lies on, or that bears its leaf."""

class Reconstruction:
    """A tree made of points."""

    @property
    def skeleton(self) -> Skeleton: ...
    @property
    def offset(self) -> list[float]: ...
    @property
    def is_measured(self) -> NDArray[np.bool_]:
        """True for nodes with a measured cylinder, ``(n,)``: a view. Other radii follow from what the limb bears."""

    @property
    def is_wood(self) -> NDArray[np.bool_]:
        """True for the points of the cloud that the tree is made of, ``(n,)``; empty for a tree of a stand, which has this itself."""

    @property
    def is_leaf(self) -> NDArray[np.bool_]:
        """True for points set aside as leaves, ``(n,)``; empty for a tree of a stand."""

    @property
    def ground(self) -> int:
        """Points set aside as ground."""

    def completed(
        self,
        *,
        spacing: float = 0.08,
        reach: int = 6,
        thickest: float = 0.02,
        tip_radius: float = 0.0015,
        seed: int = 1,
    ) -> tuple[Skeleton, int]:
        """The tree with made-up twigs on limbs whose radius is at most `thickest`, and the number of measured nodes: they come
        first and stay as they are. `spacing` and `reach` are those of the graph in which twigs grow. Metres."""

class ReconstructedStand:
    """The trees made of one cloud."""

    @property
    def trees(self) -> list[Reconstruction]: ...
    @property
    def owners(self) -> NDArray[np.int64]:
        """The number of the tree that each point was given to, -1 for none, ``(n,)``: a view."""

    @property
    def is_wood(self) -> NDArray[np.bool_]:
        """True for points that trees are made of, ``(n,)``."""

    @property
    def is_leaf(self) -> NDArray[np.bool_]:
        """True for points set aside as leaves, ``(n,)``."""

    @property
    def is_ground(self) -> NDArray[np.bool_]:
        """True for points set aside as ground, ``(n,)``."""

    def __len__(self) -> int: ...

class Example:
    """Traits of a tree, measured or grown, and more trees of its kind."""

    def __init__(self, skeleton: Skeleton) -> None: ...
    @property
    def trunk(self) -> dict[str, Any]:
        """Its chord, waywardness, clear_bole and diameter, as `treesynth::guided::TrunkTraits` documents them."""

    @property
    def orders(self) -> list[dict[str, Any]]:
        """Traits of the branches of each order, the trunk first, as `treesynth::guided::OrderTraits` documents them."""

    def tuned(self, nodes: int = 40_000, trials: int = 8) -> Example:
        """Corrected by `trials` trees that are grown and measured; takes as long as growing them."""

    def grow(self, nodes: int = 40_000, seed: int = 1) -> Skeleton:
        """A tree of the kind, on a graph of about `nodes` nodes."""

def names(system: System | None = None) -> list[_Name]:
    """Names that `grow` (species, guided), `fill` (variational), `Forest` (self-organizing) and `Growth` (growth) take."""

def grow(
    name: str,
    *,
    seed: int | None = None,
    nodes: int | None = None,
    season: Literal["winter", "summer", "autumn"] | None = None,
    height: float | None = None,
    dbh: float | None = None,
    age: float | None = None,
    day: float | None = None,
    stand_spacing: float | None = None,
    years_dead: float | None = None,
    storm_damage: float | None = None,
    progress: Progress | None = None,
) -> Tree:
    """A tree of a species or of a preset of the guided system.

    Of species: height, DBH (diameter 1.3 m above the base) and `stand_spacing` in metres, age in years, day of the year from 1 to
    366, years since it died, the part of its limbs that a storm broke (0 to 1). Of presets: nodes of the graph, season.
    """

def fill(
    shape: Path,
    *,
    nodes: int | None = None,
    height: float | None = None,
    up: Up | None = None,
    seed: int | None = None,
    progress: Progress | None = None,
) -> Tree:
    """A bare tree that fills a mesh (.obj, .stl, .ply, .glb, .gltf), a drawing (.svg: the front, and the side if there is a second
    shape), or the shape of a preset. `height` in metres, by default 8; `nodes` of the shape, by default 4000."""

def read_trees(
    path: Path, *, up: Up = "z", unit: float = 1.0, offset: Point | None = None
) -> tuple[list[Skeleton], list[float]]:
    """All trees of a .json, .swc, .csv or .qsm (QSM table) or .mtg file, and the offset taken off its coordinates."""

def scan(
    tree: Tree,
    *,
    places: ArrayLike | None = None,
    distance: float = 10.0,
    stations: int = 3,
    step: float = 0.0006,
    noise: float = 0.002,
    range: float = 100.0,
    ground: float | None = None,
    leaves: bool = True,
    seed: int = 1,
) -> Scan:
    """Scans a tree from `places` ``(n, 3)``, or from `stations` at `distance` around it. Steps in radians, all else in metres."""

def reconstruct(
    cloud: Cloud,
    *,
    base: Point | None = None,
    side: float | None = None,
    gap: float = 0.5,
    tip_radius: float = 0.0015,
    ground: bool = True,
    set_leaves_aside: bool = False,
) -> Reconstruction:
    """The skeleton and radii of the one tree whose points these are: leaf-off, or in leaf with `set_leaves_aside`. Metres."""

def reconstruct_stand(
    cloud: Cloud,
    *,
    bases: ArrayLike | None = None,
    side: float | None = None,
    gap: float = 0.5,
    tip_radius: float = 0.0015,
    ground: bool = True,
    set_leaves_aside: bool = False,
) -> ReconstructedStand:
    """All trees of a cloud: one for each trunk that is found, or for each of `bases` ``(n, 3)``. Metres."""

def write_tileset(
    path: Path,
    tiles: Sequence[
        tuple[str, str, Sequence[float], Sequence[Sequence[float]], Sequence[float]]
    ],
    *,
    position: tuple[float, float, float] | None = None,
) -> None:
    """Writes a 3D Tiles 1.1 `tileset.json`: for each tile the names of its near and far model, its origin, and what `save_models`
    returned. `position` is the place on the globe of the landscape's origin: longitude and latitude in degrees, and metres above the
    ellipsoid."""
