//! Remarks on a scene whose image may not be the intended one, before anything is rendered.

use super::{Bounds, Camera, Primitive, Scene, View};
use crate::math::{Vec3, dot};

/// The part of the image plane in front of which a mesh counts as seen: filters reach a little beyond the edges.
const REACH: f64 = 0.51;

/// Whether part of a box may be in the view. With a lens, the view is a little wider at every depth.
fn may_see(view: &View, bounds: &Bounds) -> bool {
    let Camera { position, direction, lens, .. } = view.camera;
    let edge = |(across, upward): (f64, f64)| view.right * across + view.up * upward + direction;
    let edges = [(-REACH, -REACH), (REACH, -REACH), (REACH, REACH), (-REACH, REACH)].map(edge);
    let sides = (0..4).map(|k| {
        let normal = edges[k].cross(edges[(k + 1) % 4]).normalized();
        if dot(normal, direction) < 0.0 { -normal } else { normal }
    });
    let corners = [0_usize, 1, 2, 3, 4, 5, 6, 7].map(|k| {
        let [x, y, z] = [0, 1, 2].map(|axis| if k >> axis & 1 == 0 { bounds.low[axis] } else { bounds.high[axis] });
        Vec3::new(x, y, z) - position
    });
    let is_outside = |inwards: Vec3| {
        corners.iter().all(|corner| {
            let slack = lens.map_or(0.0, |lens| lens.radius * (1.0 + dot(*corner, *corner).sqrt() / lens.focus));
            dot(*corner, inwards) < -slack
        })
    };
    !sides.chain([direction]).any(is_outside)
}

impl Scene {
    /// Returns its remarks, and those on meshes that the view does not contain.
    pub fn remarks_in(&self, view: &View) -> Vec<String> {
        self.remarks.iter().cloned().chain(self.unseen_meshes(view)).collect()
    }

    /// Returns remarks on meshes that the view does not contain: one for each, with its bounds.
    pub(super) fn unseen_meshes(&self, view: &View) -> impl Iterator<Item = String> {
        self.meshes.iter().filter_map(|mesh| {
            let first = self.owners.len() - self.primitives.triangles.len();
            let triangles = self.primitives.triangles.iter().zip(&self.owners[first..]);
            let own = triangles.filter(|(_, owner)| *owner == mesh).filter_map(|(triangle, _)| triangle.bounds());
            let bounds = own.fold(Bounds::EMPTY, |all, bounds| all.and(&bounds));
            let name = &self.objects[*mesh as usize].name;
            let Bounds { low: [a, b, c], high: [d, e, f] } = bounds;
            (!may_see(view, &bounds)).then(|| {
                format!(
                    "{name}: the camera does not see this mesh, which extends from ({a:?}, {b:?}, {c:?}) to ({d:?}, \
                     {e:?}, {f:?}); `scale`, `rotate` and `translate` place a mesh"
                )
            })
        })
    }

    pub(super) fn remarks_on_light(&self) -> Vec<String> {
        let is_open = self.background.is_some();
        let has_background = self.background.is_some_and(|radiance| !radiance.is_black());
        let has_light = has_background
            || !self.point_lights.is_empty()
            || self.objects.iter().any(|object| !object.emission.is_black())
            || self.fog.is_some_and(|fog| !fog.emission.is_black());
        let clearest = self.fog.map(|fog| fog.absorption.r.min(fog.absorption.g).min(fog.absorption.b));
        let scattering = self.fog.map_or(0.0, |fog| fog.scattering);
        let mut remarks = Vec::new();
        if !has_light {
            remarks.push("no object emits and there is no background, point light or glowing fog: the image is black");
        }
        if is_open && scattering > 0.0 && clearest == Some(0.0) {
            remarks.push(
                "the fog scatters without absorbing, and the scene is open: paths that leave the surfaces do not end \
                 before the largest depth, which takes long; absorption, a closed scene without `background` or \
                 --max-depth ends them",
            );
        }
        if has_background && (scattering > 0.0 || clearest.is_some_and(|clearest| clearest > 0.0)) {
            remarks.push("the fog has no end, so no light of the background reaches the camera");
        }
        remarks.into_iter().map(str::to_string).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::scene::{Library, Scene};

    /// A ball that emits as stated, with further lines of a scene.
    fn remarks(emission: f64, more: &str) -> Vec<String> {
        let text = format!(
            "about = 'a ball'\n{more}\n[camera.pinhole]\nposition = [0.0, 0.0, 9.0]\nlook-at = [0.0, 0.0, 0.0]\nfield-of-view = 40.0\n\
             [[objects]]\nname = 'ball'\nshape = {{ sphere = {{ center = [0.0, 0.0, 0.0], radius = 1.0 }} }}\n\
             material = {{ diffuse = {{ albedo = [0.5, 0.5, 0.5] }} }}\nemission = [0.0, {emission:?}, 0.0]\n"
        );
        Scene::from_toml(&text).unwrap().remarks
    }

    #[test]
    fn a_scene_without_light_says_so() {
        let dark = "no object emits and there is no background";
        let told = |emission, more| remarks(emission, more).iter().any(|remark| remark.starts_with(dark));
        assert!(told(0.0, "") && told(0.0, "background = [0.0, 0.0, 0.0]"));
        let lamp = "point-lights = [{ position = [0.0, 5.0, 0.0], intensity = [1.0, 1.0, 1.0] }]";
        let glow = "fog = { absorption = [0.1, 0.1, 0.1], scattering = 0.0, emission = [1.0, 1.0, 1.0] }";
        assert!(!told(0.5, "") && !told(0.0, "background = [0.0, 0.1, 0.0]") && !told(0.0, lamp) && !told(0.0, glow));
    }

    /// Light from an infinite distance passes no fog, and a path ends only if it leaves, is absorbed or is cut.
    #[test]
    fn fog_without_an_end_is_told() {
        let told = |background: &str, absorption: [f64; 3], scattering: f64| {
            let fog = format!("{background}\nfog = {{ absorption = {absorption:?}, scattering = {scattering:?} }}");
            let remarks = remarks(1.0, &fog);
            let has = |text: &str| remarks.iter().any(|remark| remark.contains(text));
            (has("do not end before the largest depth"), has("no light of the background"))
        };
        let sky = "background = [0.5, 0.7, 1.0]";
        assert_eq!(told(sky, [0.0; 3], 0.01), (true, true));
        assert_eq!(told(sky, [0.1, 0.0, 0.1], 0.01), (true, true));
        assert_eq!(told(sky, [0.1; 3], 0.01), (false, true));
        assert_eq!(told(sky, [0.1; 3], 0.0), (false, true));
        assert_eq!(told(sky, [0.1, 0.0, 0.1], 0.0), (false, false));
        assert_eq!(told("background = [0.0, 0.0, 0.0]", [0.0; 3], 0.01), (true, false));
        assert_eq!(told("", [0.0; 3], 0.01), (false, false));
    }

    #[test]
    fn the_programs_own_scenes_need_no_remark() {
        let library = Library::default();
        for name in library.names() {
            let scene = library.load(name).unwrap();
            assert!(scene.remarks.iter().all(|remark| remark.contains("are not used")), "{name}: {:?}", scene.remarks);
            assert_eq!(scene.unseen_meshes(&scene.camera.view(64, 48)).collect::<Vec<_>>(), [""; 0], "{name}");
        }
    }
}
