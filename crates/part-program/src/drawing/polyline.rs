//! LWPOLYLINE, and POLYLINE with its vertices.

use super::affine::Affine;
use super::conic::bulged;
use super::groups::{Entity, Group};
use super::item::Item;
use crate::diagnostic::Report;
use crate::moves::Shape;
use crate::source::Span;

/// Bits of group 70 of a POLYLINE.
const CLOSED: u32 = 1;
const IN_SPACE: u32 = 8;
const MESH: u32 = 16 | 64;
/// Bit of group 70 of a VERTEX that is a control point of a spline through others: it is not drawn.
const FRAME: u32 = 16;

/// A vertex, and the bulge of the segment that follows.
struct Vertex {
    point: [f64; 3],
    bulge: f64,
    span: Span,
}

/// Reads an LWPOLYLINE. Its vertices are groups of the entity itself.
pub(crate) fn read_light<'t>(entity: &Entity<'t>, report: &mut Report<'_>, items: &mut Vec<Item<'t>>) {
    let plane = entity.plane(report);
    let height = entity.number(report, 38).unwrap_or(0.0);
    let closed = entity.flags(report, 70) & CLOSED != 0;
    let points = entity.points(report, 10);
    let Some(bulges) = bulges(entity, report) else { return };
    let vertices: Vec<_> = points
        .iter()
        .zip(bulges)
        .map(|(([x, y, _], span), bulge)| Vertex { point: [*x, *y, height], bulge, span: *span })
        .collect();
    if let Some(plane) = plane.filter(|_| has_length(entity, &vertices, report)) {
        segments(&vertices, closed, &plane, items);
    }
}

/// The bulge behind each vertex: a group 42 follows the vertex to which it belongs.
fn bulges(entity: &Entity<'_>, report: &mut Report<'_>) -> Option<Vec<f64>> {
    let mut bulges = Vec::new();
    let mut sound = true;
    for group in &entity.groups {
        match group.code {
            10 => bulges.push(0.0),
            42 => match bulges.last_mut().zip(bulge(group)) {
                Some((bulge, value)) => *bulge = value,
                None => {
                    report
                        .error(group.span, "this bulge is none")
                        .expected("a number after the vertex it belongs to");
                    sound = false;
                }
            },
            _ => {}
        }
    }
    sound.then_some(bulges)
}

fn bulge(group: &Group<'_>) -> Option<f64> {
    group.text.parse::<f64>().ok().filter(|value| value.is_finite())
}

/// Whether a POLYLINE is a net of faces, which is not a path.
pub(crate) fn is_mesh(entity: &Entity<'_>, report: &mut Report<'_>) -> bool {
    entity.flags(report, 70) & MESH != 0
}

/// Reads a POLYLINE that is not a mesh.
pub(crate) fn read<'t>(entity: &Entity<'t>, report: &mut Report<'_>, items: &mut Vec<Item<'t>>) {
    let flags = entity.flags(report, 70);
    let in_space = flags & IN_SPACE != 0;
    let plane = if in_space { Some(Affine::scaling([1.0; 3])) } else { entity.plane(report) };
    // In a plane polyline, the vertices have the height of the polyline.
    let height = entity.number(report, 30).filter(|_| !in_space);
    let mut vertices = Vec::with_capacity(entity.vertices.len());
    for vertex in &entity.vertices {
        if vertex.flags(report, 70) & FRAME != 0 {
            continue;
        }
        let [x, y, z] = vertex.point(report, 10, "place").unwrap_or([f64::NAN; 3]);
        let bulge = vertex.number(report, 42).filter(|_| !in_space).unwrap_or(0.0);
        vertices.push(Vertex { point: [x, y, height.unwrap_or(z)], bulge, span: vertex.span });
    }
    if let Some(plane) = plane.filter(|_| has_length(entity, &vertices, report)) {
        segments(&vertices, flags & CLOSED != 0, &plane, items);
    }
}

/// Whether there are enough vertices and all of them are numbers; other values have been reported.
fn has_length(entity: &Entity<'_>, vertices: &[Vertex], report: &mut Report<'_>) -> bool {
    if vertices.len() < 2 {
        let message = format!("this {} has no length", entity.name);
        report.error(entity.span, message).expected("two vertices or more");
    }
    vertices.len() > 1
        && vertices
            .iter()
            .all(|vertex| vertex.bulge.is_finite() && vertex.point.iter().all(|x| x.is_finite()))
}

/// Draws from vertex to vertex.
fn segments(vertices: &[Vertex], closed: bool, plane: &Affine, items: &mut Vec<Item<'_>>) {
    let next = vertices.iter().skip(1).chain(vertices.first().filter(|_| closed));
    items.extend(vertices.iter().zip(next).map(|(vertex, next)| {
        let (from, to, span) = (vertex.point, next.point, vertex.span);
        if vertex.bulge == 0.0 || from == to {
            Item::straight(plane.point(from), plane.point(to), span)
        } else {
            let curve = plane.curve(bulged(from, to, vertex.bulge));
            Item::Curve { curve, shape: Shape::Arc, span }
        }
    }));
}
