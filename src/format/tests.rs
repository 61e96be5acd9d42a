use glam::{DVec3, Vec3};
use proptest::prelude::*;

use super::*;
use crate::cloud::Frame;
use crate::shape::UpAxis;

fn qsm(text: &str) -> Result<Trees, FormatError> {
    read_qsm(&Frame::default().with_up(UpAxis::Y), text.as_bytes())
}

fn swc(text: &str) -> Result<Trees, FormatError> {
    read_swc(&Frame::default().with_up(UpAxis::Y), text.as_bytes())
}

fn mtg(text: &str) -> Result<Trees, FormatError> {
    read_mtg(&Frame::default().with_up(UpAxis::Y), text.as_bytes())
}

fn refused(read: Result<Trees, FormatError>, parts: &[&str]) {
    let error = read.and_then(Trees::single).map(|tree| tree.len()).expect_err(parts[0]).to_string();
    for part in parts {
        assert!(error.contains(part), "{error} lacks {part}");
    }
}

/// A trunk of two cylinders and a lateral from the middle of the second.
const START: &str = "ID,parentID,startX,startY,startZ,endX,endY,endZ,radius,length,branchOrder\n";
const ROWS: [&str; 3] =
    ["1,0,0,0,0,0,1,0,.1,1,0\n", "2,1,0,1,0,0,2,0,.08,1,0\n", "3,2,0.05,1.5,0,1,2,0,.02,1,1\n"];

#[test]
fn laterals_leave_cylinders_where_they_begin() {
    let trees = qsm(&format!("{START}{}", ROWS.concat())).expect("a table");
    assert_eq!((trees.inserted, trees.has_orders), (1, true));
    assert!((trees.widest_gap - 0.05).abs() < 1e-9);
    let tree = trees.single().expect("one tree");
    assert_eq!(tree.positions()[2], Vec3::Y * 1.5);
    assert_eq!((tree.parent(4), tree.orders()), (Some(2), &[0, 0, 0, 0, 1][..]));
    // Any order of rows gives the same trees, and numbers may have gaps.
    for order in [[2, 0, 1], [1, 2, 0], [2, 1, 0]] {
        let rows: String = order.iter().map(|&row| ROWS[row]).collect();
        let other = qsm(&format!("{START}{rows}")).expect("a table").single().expect("one tree");
        let mut sorted: Vec<_> = other.positions().iter().map(|p| p.to_array().map(f32::to_bits)).collect();
        let mut wanted: Vec<_> = tree.positions().iter().map(|p| p.to_array().map(f32::to_bits)).collect();
        sorted.sort_unstable();
        wanted.sort_unstable();
        assert_eq!(sorted, wanted);
    }
}

#[test]
fn names_of_other_programs_are_known() {
    let rows = |rows: &[&str]| rows.concat();
    let tables = [
        // rTwig.
        (
            "id,parent,start_x,start_y,start_z,end_x,end_y,end_z,radius\n",
            ["1,0,0,0,0,0,1,0,.1\n", "2,1,0,1,0,0,2,0,.05\n"],
        ),
        // TreeQSM as MATLAB's writetable has it: no numbers, 1-based parents, axis and length.
        (
            "radius,length,start_1,start_2,start_3,axis_1,axis_2,axis_3,parent,extension,BranchOrder\n",
            [".1,1,0,0,0,0,1,0,0,2,0\n", ".05,1,0,1,0,0,1,0,1,0,0\n"],
        ),
        // TreeQSM's text files.
        (
            "radius (m)\tlength (m)\tstart_point\taxis_direction\tparent\textension\tbranch\tbranch_order\n",
            [".1\t1\t0\t0\t0\t0\t1\t0\t0\t2\t1\t0\n", ".05\t1\t0\t1\t0\t0\t1\t0\t1\t0\t1\t0\n"],
        ),
        // SimpleForest: from 0, no parent is -1.
        (
            "ID;parentID;startX;startY;startZ;endX;endY;endZ;radius\n",
            ["0;-1;0;0;0;0;1;0;0,1\n", "1;0;0;1;0;0;2;0;0,05\n"],
        ),
        // aRchi, by R's write.table: the column of the rows' names has none.
        (
            "\"startX\" \"startY\" \"startZ\" \"endX\" \"endY\" \"endZ\" \"cyl_ID\" \"parent_ID\" \"radius_cyl\" \"branching_order\"\n",
            ["\"1\" 0 0 0 0 1 0 1 NA .1 0\n", "\"2\" 0 1 0 0 2 0 2 1 .05 0\n"],
        ),
    ];
    for (header, body) in tables {
        let header = header.replace('"', if header.starts_with('"') { "" } else { "\"" });
        let tree = qsm(&format!("{header}{}", rows(&body))).expect(&header).single().expect("one tree");
        assert_eq!(tree.positions(), [Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0], "{header}");
        assert_eq!(tree.radii(), [0.1, 0.1, 0.05], "{header}");
    }
}

#[test]
fn what_is_wrong_with_a_qsm_is_named() {
    let with = |at: usize, row: &str| {
        let mut rows = ROWS;
        rows[at] = row;
        qsm(&format!("{START}{}", rows.concat()))
    };
    refused(qsm(""), &["empty"]);
    refused(qsm(START), &["no rows"]);
    refused(
        qsm(&format!("{}{}", START.replace("radius", "thickness"), ROWS.concat())),
        &["no column radius", "thickness"],
    );
    refused(qsm(&format!("{}{}", START.replace("endX", "x"), ROWS.concat())), &["endX, endY, endZ"]);
    refused(with(1, "2,1,0,1,0,0,2,0,-.08,1,0\n"), &["line 3", "column radius", "-0.08"]);
    refused(with(1, "2,1,0,1,0,0,2,0,NaN,1,0\n"), &["line 3", "column radius", "NaN"]);
    refused(with(1, "2,1,0,1,0,0,x,0,.1,1,0\n"), &["line 3", "column endY", "\"x\""]);
    refused(with(1, "2,1,0,1\n"), &["line 3", "4 fields", "11"]);
    refused(with(1, "1,0,0,1,0,0,2,0,.1,1,0\n"), &["line 3", "column ID", "1 stands in line 2 too"]);
    refused(with(1, "2,77,0,1,0,0,2,0,.1,1,0\n"), &["line 3", "column parentID", "77"]);
    refused(with(1, "2,3,0,1,0,0,2,0,.1,1,0\n"), &["line 3", "circle"]);
    refused(with(1, "2,1.5,0,1,0,0,2,0,.1,1,0\n"), &["line 3", "whole number"]);
    refused(with(1, "2,0,0,1,0,0,2,0,.1,1,0\n"), &["2 trees"]);
    refused(with(0, "1,0,0,0,0,9e9,1,0,.1,1,0\n"), &["9000000000", "10 km"]);
    let far = format!("{START}1,0,0,0,0,9e9,1,0,.1,1,0\n");
    refused(
        read_qsm(&Frame::default().with_offset(DVec3::ZERO), far.as_bytes()),
        &["9000000000", "1e6", "Frame::with_offset"],
    );
    assert_eq!(with(1, "2,1,0,1,0,0,2,0,0,1,0\n").map(|trees| trees.trees.len()).ok(), Some(1));
    let lone = Skeleton::new(vec![Vec3::ZERO], vec![None]).expect("a root");
    assert!(write_qsm(&lone, &Frame::default(), &mut Vec::new()).is_err());
}

#[test]
fn what_is_wrong_with_an_swc_is_named() {
    let base = "5 1 0 0 0 .2 -1\n90 3 0 2 0 .1 7\n7 3 0 1 0 .1 5 and more\n";
    let tree = swc(base).expect("sound").single().expect("one tree");
    assert_eq!(tree.positions(), [Vec3::ZERO, Vec3::Y, Vec3::Y * 2.0]);
    refused(swc("# nothing\n"), &["no rows"]);
    refused(swc(&base.replace(" .2 -1", " .2")), &["line 1", "6 words"]);
    refused(swc(&base.replace(" .1 7", " -1 7")), &["line 2", "radius"]);
    refused(swc(&base.replace("90 3", "5 3")), &["line 2", "5 stands in line 1"]);
    refused(swc(&base.replace(".1 7", ".1 8")), &["line 2", "8 is the id of no row", "-1"]);
    refused(swc(&base.replace(".2 -1", ".2 90")), &["circle"]);
    refused(swc(&base.replace("0 2 0", "0 inf 0")), &["line 2", "column y", "inf"]);
    refused(swc(&base.replace(".1 5", ".1 -1")), &["2 trees"]);
    let trees = swc(&base.replace(".1 7", ".1 -1")).expect("two trees");
    assert_eq!(trees.trees.iter().map(Skeleton::len).collect::<Vec<_>>(), [2, 1]);
}

const HEAD: &str = "CODE: FORM-A\nCLASSES:\nSYMBOL\tSCALE\tDECOMPOSITION\tINDEXATION\tDEFINITION\n$\t0\tFREE\tFREE\tIMPLICIT\nP\t1\tFREE\tFREE\tEXPLICIT\n\
    A\t2\tFREE\tFREE\tEXPLICIT\nN\t3\tFREE\tFREE\tEXPLICIT\nDESCRIPTION:\nLEFT\tRIGHT\tRELTYPE\tMAX\nFEATURES:\nNAME\tTYPE\nMTG:\nENTITY-CODE\t\tXX\tYY\tZZ\tDiam\n";

#[test]
fn axes_of_an_mtg_are_orders() {
    let body = "/P1\n^/A1\n^/N1\t\t0\t0\t0\t2\n^<N2\t\t0\t1\t0\t1 # upper\n\t+A2/N1\t1\t1\t0\t.5\n\t^<N2\t2\t1\t0\t\n^<N3\t\t0\t2\t0\t1\n/P2/A1/N1\t\t9\t0\t0\t1\n";
    let trees = mtg(&format!("{HEAD}{body}")).expect("sound");
    assert_eq!(trees.trees.len(), 2);
    let tree = &trees.trees[0];
    assert_eq!(tree.orders(), [0, 0, 1, 1, 0]);
    assert_eq!(tree.radii(), [1.0, 0.5, 0.25, 0.25, 0.5]);
    assert_eq!((tree.parent(2), tree.parent(4)), (Some(1), Some(1)));
    let with = |from: &str, to: &str| mtg(&format!("{HEAD}{}", body.replace(from, to)));
    refused(with("^<N2\t\t0", "^N2\t\t0"), &["line 17", "must be made of"]);
    refused(with("^<N2\t\t0", "^<Q2\t\t0"), &["line 17", "class \"Q\""]);
    refused(with("^<N2\t\t0", "^<<N2\t\t0"), &["line 17", "class \"\""]);
    refused(with("^<N2\t\t0", "^\t\t0"), &["line 17", "alone"]);
    refused(with("^<N2\t\t0", "^<N2<N3\t\t0"), &["line 17", "several nodes"]);
    refused(with("^<N2\t\t0\t1", "^<N2\t\t0\tx"), &["line 17", "column YY", "\"x\""]);
    refused(with("\t1 # upper", "\t-1"), &["line 17", "column Diam"]);
    refused(with("/P1\n^/A1\n^/N1", "\n\n<N1"), &["follows nothing"]);
    refused(mtg(HEAD), &["no rows"]);
    refused(mtg("CODE: FORM-A\n"), &["MTG:"]);
    refused(mtg(&HEAD.replace("XX", "U")), &["XX, YY and ZZ"]);
}

/// Skeletons of all shapes: parents anywhere before, radii from 0, coordinates of a forest.
fn skeletons() -> impl Strategy<Value = Skeleton> {
    let node =
        (any::<prop::sample::Index>(), prop::array::uniform3(-900.0_f32..900.0), 0.0_f32..2.0, any::<bool>());
    prop::collection::vec(node, 2..40).prop_map(|nodes| {
        let positions = nodes.iter().map(|node| Vec3::from_array(node.1)).collect();
        let parents: Vec<Option<u32>> =
            nodes.iter().enumerate().map(|(i, node)| (i > 0).then(|| node.0.index(i) as u32)).collect();
        // The first child goes on or not, as it comes, the root's always; the others are laterals.
        let mut orders = vec![0_u16];
        let mut goes_on = vec![false; nodes.len()];
        for (node, parent) in parents.iter().enumerate().skip(1) {
            let parent = parent.unwrap_or(0) as usize;
            let is_axis = (nodes[node].3 || node == 1) && !std::mem::replace(&mut goes_on[parent], true);
            orders.push(orders[parent] + u16::from(!is_axis));
        }
        Skeleton::new(positions, parents)
            .and_then(|s| s.with_radii(nodes.iter().map(|node| node.2).collect()))
            .and_then(|s| s.with_orders(orders))
            .expect("made to be sound")
    })
}

proptest! {
    #[test]
    fn round_trips_lose_what_the_docs_say(
        tree in skeletons(),
        up in prop::sample::select(vec![UpAxis::Y, UpAxis::Z]),
        unit in prop::sample::select(vec![1.0, 0.001, 0.0254]),
        offset in prop::sample::select(vec![DVec3::ZERO, DVec3::new(478_123.0, 5_429_876.0, 211.0)]),
    ) {
        let frame = Frame::default().with_up(up).with_unit(unit).with_offset(offset);
        let mut files = [Vec::new(), Vec::new(), Vec::new()];
        write_qsm(&tree, &frame, &mut files[0]).expect("written");
        write_swc(&tree, &frame, &mut files[1]).expect("written");
        write_mtg(&tree, &frame, &mut files[2]).expect("written");
        let read = [read_qsm(&frame, &files[0][..]), read_swc(&frame, &files[1][..]), read_mtg(&frame, &files[2][..])];
        for (format, trees) in read.into_iter().enumerate() {
            let trees = trees.expect("read");
            prop_assert_eq!((trees.offset, trees.inserted), (offset, 0));
            let back = trees.single().expect("one tree");
            prop_assert!(back.edges().eq(tree.edges()), "{}", String::from_utf8_lossy(&files[format]));
            prop_assert_eq!(&back.radii()[1..], &tree.radii()[1..]);
            if format != 0 {
                prop_assert_eq!(back.radii()[0].to_bits(), tree.radii()[0].to_bits());
            }
            if format != 1 {
                prop_assert_eq!(back.orders(), tree.orders());
            }
            for (a, b) in back.positions().iter().zip(tree.positions()) {
                let tolerance = if offset == DVec3::ZERO { 0.0 } else { 1e-4 };
                prop_assert!(a.distance(*b) <= tolerance, "{a} {b}");
            }
        }
    }

    #[test]
    fn no_text_is_trouble(text in "[ -~\t\n]{0,200}") {
        let _ = (qsm(&text), swc(&text), mtg(&text));
        let _ = (qsm(&format!("{START}{text}")), mtg(&format!("{HEAD}{text}")));
    }
}

#[test]
fn orders_that_count_from_one_and_rows_that_end_in_a_comma() {
    let table = "ID,parentID,startX,startY,startZ,endX,endY,endZ,radius,branchOrder\n\
        1,0,0,0,0,0,0,1,0.2,1,\n2,1,0,0,1,0,0,2,0.1,1,\n3,1,0,0,1,1,0,2,0.05,2,\n";
    let tree = read_qsm(&Frame::default(), table.as_bytes()).unwrap().single().unwrap();
    let longest = tree.branches().iter().next().expect("a stem").nodes().len();
    assert_eq!((tree.branches().len(), longest), (2, 3), "the stem is the first branch");
}
