//! Facets that wear images.

use super::{Facet, Frame, MIDDLE};
use crate::preview::light::Surface;
use crate::preview::wear::{Cutout, Flat, Footprint, Wear};
use glam::Vec3;

impl Frame<'_> {
    /// The holes of a facet, where it is seen.
    #[inline]
    pub(super) fn cutout(&self, facet: Facet) -> Option<Cutout<'_>> {
        let cut = self.parts[facet.part as usize].holes(facet.corners)?;
        Some(cut.on(self.places(facet), self.view.is_perspective()))
    }

    /// Look of a facet by its images at a place of the picture; `None` if it has none.
    pub(super) fn worn(
        &self,
        facet: Facet,
        weights: [f32; 3],
        point: Vec3,
        (x, y): (f32, f32),
    ) -> Option<Surface> {
        let part = &self.parts[facet.part as usize];
        let wear = part.wear()?;
        let footprint = self.flat(facet).footprint(x, y, self.samples as f32);
        Some(self.surface(facet, weights, point, wear, &footprint))
    }

    /// Mean look of a facet by its images.
    pub(super) fn worn_middle(&self, facet: Facet, point: Vec3) -> Option<Surface> {
        let wear = self.parts[facet.part as usize].wear()?;
        Some(self.surface(facet, MIDDLE, point, wear, &self.flat(facet).whole()))
    }

    fn flat(&self, facet: Facet) -> Flat {
        let uvs = self.parts[facet.part as usize].uvs(facet.corners);
        Flat { places: self.places(facet), uvs, perspective: self.view.is_perspective() }
    }

    fn surface(
        &self,
        facet: Facet,
        weights: [f32; 3],
        point: Vec3,
        wear: &Wear<'_>,
        footprint: &Footprint,
    ) -> Surface {
        let part = &self.parts[facet.part as usize];
        let seen = self.normal(facet, weights);
        let normal = wear.normal(footprint).and_then(|relief| {
            // Images are drawn on the front; the back shows the same relief from behind.
            let front = if facet.flipped { -seen } else { seen };
            let tangent = part.tangent(facet.corners, weights, front)?;
            let across = tangent.truncate();
            let up = front.cross(across) * tangent.w;
            let normal = (across * relief.x + up * relief.y + front * relief.z).normalize_or(front);
            Some(if facet.flipped { -normal } else { normal })
        });
        let tint = part.color(facet.corners, weights);
        let fine = wear.occlusion_roughness(footprint);
        Surface {
            normal: normal.unwrap_or(seen),
            color: tint * wear.color(footprint),
            transmitted: wear.transmission(footprint).map(|color| tint * color),
            occlusion: fine.map_or(1.0, |(occlusion, _)| occlusion),
            gloss: fine.map(|(_, roughness)| (roughness * part.roughness(), self.view.towards(point))),
        }
    }
}
