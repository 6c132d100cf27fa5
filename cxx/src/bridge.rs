//! The interface, from which `cxx` makes the C++ header; the comments below go there with it.

use crate::body::Body;
use crate::clip::{Clip, Motion, builtin_clips};
use crate::context::Context;
use crate::mesh::{Mesh, MeshPart};
use crate::model::{Model, humanoid_bones, measure_names, version};
use crate::request::Request;
use crate::scene::Scene;
use crate::skin::{Skinner, skin_many};

// What `cxx` generates calls across the languages, which is what the crate is for, and is `pub` throughout and
// needs lifetimes by name in results.
#[allow(unsafe_code, unreachable_pub, clippy::needless_lifetimes)]
#[cxx::bridge(namespace = "anthronet")]
pub(crate) mod ffi {
    /// Female or male; of a request also neither.
    enum Sex {
        /// Inferred from the measures.
        Any,
        Female,
        Male,
    }

    /// How measures that a request does not give are filled.
    enum Fill {
        /// With their most likely values, given the others.
        Mean,
        /// By a draw from their distribution, given the others; the seed chooses.
        Sample,
    }

    /// Axes and handedness of the model. Lengths are metres in all of them, and bones run along their joint's +Y.
    enum Space {
        /// Right-handed, +Y up, the character faces +Z and has its left at +X: glTF, USD, the library's own.
        Gltf,
        /// Right-handed, +Z up, the character faces -Y and has its left at +X: Blender.
        Blender,
        /// Left-handed, +Y up, the character faces +Z and has its left at -X: Unity. Faces have the opposite winding.
        Unity,
    }

    /// Which vertices and faces a mesh has.
    enum Layout {
        /// One texture coordinate per vertex (vertices at seams are doubled) and triangles only: for drawing.
        Render,
        /// The model's own vertices and quads, texture coordinates per corner: for editing and measuring.
        Model,
    }

    /// The vocabulary that joints are named in.
    enum JointNames {
        /// The rig's own, such as `upperarm_l`.
        Native,
        /// Unity's `HumanBodyBones`, such as `LeftUpperArm`.
        Unity,
        /// Mixamo's, such as `mixamorig:LeftArm`.
        Mixamo,
        /// VRM 1.0's, such as `leftUpperArm`.
        Vrm,
        /// Blender's, such as `upper_arm.L`.
        Blender,
    }

    /// How joints move vertices.
    enum SkinMethod {
        /// Linear blend skinning: what glTF, UsdSkel and game engines do.
        Linear,
        /// Dual quaternions: Blender's "Preserve Volume".
        DualQuaternion,
        /// The paper's formula: joints move vertices but do not turn them.
        JointTranslation,
    }

    /// What a clip does outside its duration.
    enum Wrap {
        /// Holds its first or last frame.
        Once,
        /// Starts over; its last frame is its first.
        Loop,
        /// As `Loop` with root motion: every cycle continues where the last one ended.
        RootMotion,
    }

    /// What a joint's transform is relative to.
    enum Relative {
        /// To its parent: what animation tracks hold.
        ToParent,
        /// To the model: what skinning takes.
        ToModel,
    }

    /// What fingers do in a retargeted clip.
    enum Fingers {
        /// Those of the motion where it has any, else relaxed.
        Source,
        /// Relaxed hands.
        Relaxed,
        /// As in the bind pose.
        Rest,
    }

    /// Which axis points up in a motion file.
    enum UpAxis {
        /// As the file says, or else found from the proportions of its skeleton.
        Found,
        Y,
        Z,
        X,
        NegativeX,
        /// +Y points down, as in the axes of cameras.
        NegativeY,
        NegativeZ,
    }

    /// Where a joint is: a rotation, then a translation.
    #[derive(Clone, Copy)]
    struct Transform {
        /// Unit quaternion x, y, z, w.
        rotation: [f32; 4],
        /// Metres.
        translation: [f32; 3],
    }

    /// A joint in the bind pose. Matrices are column-major and multiply column vectors.
    struct Joint {
        /// Its name in the rig; see `Body::joint_name` for others.
        name: String,
        /// Place of the parent, before this joint's own; -1 of the root.
        parent: i32,
        /// From the joint along its +Y axis to where its bone ends, metres.
        length: f32,
        /// Relative to the parent.
        parent_from_joint: Transform,
        /// From the joint's space to the model's.
        model_from_joint: [f32; 16],
        /// The inverse bind matrix.
        joint_from_model: [f32; 16],
    }

    /// A joint that is a bone of the standard humanoid, with its name in every vocabulary.
    struct HumanoidBone {
        native: String,
        unity: String,
        /// Name in Unity's `HumanTrait.BoneName`.
        unity_trait: String,
        mixamo: String,
        vrm: String,
        blender: String,
        /// Unity and VRM 1.0 require it.
        required: bool,
    }

    /// The values that a measure may take, metres, both ends included.
    struct MeasureRange {
        min: f64,
        max: f64,
    }

    /// One measure of a body. Metres.
    struct MeasureReport {
        /// Its name with its side, such as `arm_length_left`.
        name: String,
        /// The request gives it.
        given: bool,
        /// The value in the request; 0 for a filled measure.
        asked: f64,
        /// The value of the body.
        obtained: f64,
        /// Obtained - asked; 0 for a filled measure.
        residual: f64,
        /// Lower end of what 90 % of people with the given measures have; the value itself for a given measure.
        low90: f64,
        /// Upper end of that interval.
        high90: f64,
        /// Share of people of this sex, 0 to 100, who have at most the obtained value.
        percentile: f64,
    }

    /// A body in numbers.
    struct BodySummary {
        sex: Sex,
        seed: u64,
        mass_kg: f64,
        volume_m3: f64,
        /// Body mass index, kg/m².
        bmi: f64,
        /// Largest |obtained - asked| over the given measures, metres.
        solve_residual: f64,
        /// Steps of the exact solve.
        iterations: u32,
        /// The solve met its tolerance.
        converged: bool,
        /// Number of joints.
        joint_count: usize,
    }

    /// Measures, mass and volume of a mesh.
    struct Measured {
        /// The level of detail of the mesh, recognised by its number of vertices.
        lod: u32,
        mass_kg: f64,
        volume_m3: f64,
        /// Body mass index, kg/m².
        bmi: f64,
        /// The measures in the order of `measure_names`, metres.
        metres: Vec<f64>,
        /// In which unit and axes a file was read, if not in metres with +Y up; empty for a mesh in memory.
        warnings: Vec<String>,
    }

    /// How a mesh is made of a body. `MeshOptions{}` is the default.
    struct MeshOptions {
        /// Level of detail, 0 (finest) to 3.
        lod: u32,
        /// Influences per vertex, 4 or 8; 0 stands for 4.
        influences: u32,
        space: Space,
        layout: Layout,
        /// Leaves out eyes, teeth, tongue and lashes.
        body_only: bool,
        /// Step of the Monk skin tone scale, 1 to 10; 0 for the default tone.
        skin_tone: u32,
    }

    /// How a scene is made of a body. `SceneOptions{}` is the default.
    struct SceneOptions {
        /// Level of detail, 0 (finest) to 3.
        lod: u32,
        /// Influences per vertex, 4 or 8; 0 stands for 4.
        influences: u32,
        /// Names of the joints.
        joint_names: JointNames,
        /// Leaves out eyes, teeth, tongue and lashes.
        body_only: bool,
        /// Step of the Monk skin tone scale, 1 to 10; 0 for the default tone.
        skin_tone: u32,
        /// Compresses .glb and .gltf (EXT_meshopt_compression).
        compress: bool,
    }

    /// How a motion file is read; these values override those in the file. `MotionOptions{}` leaves everything to the
    /// file.
    struct MotionOptions {
        up: UpAxis,
        /// Metres per unit of length, such as 0.01; 0 leaves it to the file.
        metres_per_unit: f64,
        /// Frames were recorded at this rate, curves are sampled at it; 0 leaves it to the file.
        frames_per_second: f64,
        /// Which of several people in an `.npz`, from 1; 0 reads the first, and the report warns.
        person: u32,
    }

    /// How a motion is retargeted to a body. `RetargetOptions{}` is the default: joints within their limits, feet on the
    /// floor.
    struct RetargetOptions {
        fingers: Fingers,
        /// Does not keep joints within the limits of human joints.
        no_limits: bool,
        /// Does not keep feet that touch the floor from sliding and sinking in.
        no_feet: bool,
        /// Removes root motion.
        in_place: bool,
        /// Blends the end into the beginning, so that the clip loops.
        looped: bool,
        /// Puts root motion on the joint `Root` instead of the pelvis.
        root_motion: bool,
        /// Frames per second of the result; 0 keeps those of the motion.
        frames_per_second: f64,
        /// Which joint of the motion drives which joint of the rig, or none, as JSON: `{"LeftArm": "upperarm_l", "Tail":
        /// null}`; joints that it does not name are matched automatically. Empty matches all of them.
        mapping_json: String,
        /// Accepts a motion that seems to be no person's, or in which nobody stands.
        force: bool,
    }

    /// Colour and gloss of a part of a mesh.
    struct Material {
        /// Linear red, green, blue and alpha.
        base_color: [f32; 4],
        /// Perceptual roughness, 0 to 1.
        roughness: f32,
        /// Back faces are drawn too.
        double_sided: bool,
    }

    /// Displacements from a surface to another shape. Their weighted sum is added to the bind pose, before skinning.
    struct BlendShape {
        name: String,
        /// Three per vertex, metres, to be added to the positions.
        positions: Vec<f32>,
        /// Three per vertex, to be added to the normals, whose sum is then to be brought to unit length.
        normals: Vec<f32>,
    }

    /// One surface to pose. Everything is in the space of the mesh that the skinner was made of.
    struct SkinJob<'a> {
        skinner: &'a Skinner,
        method: SkinMethod,
        /// Every joint relative to the model, as `Clip::sample` fills it.
        pose: &'a [Transform],
        /// Three floats per vertex, added to the bind positions before they are posed (correctives), metres; or none.
        offsets: &'a [f32],
        /// Where three floats per vertex are written, metres.
        positions: &'a mut [f32],
        /// Where unit normals are written, three floats per vertex; or none.
        normals: &'a mut [f32],
    }

    extern "Rust" {
        /// The version of the library, such as `0.1.0`.
        fn version() -> &'static str;

        /// Names of the measures, in order.
        fn measure_names() -> Vec<String>;

        /// The bones of the standard humanoid, 55.
        fn humanoid_bones() -> Vec<HumanoidBone>;

        /// Names of the built-in clips, such as `walk`.
        fn builtin_clips() -> Vec<String>;

        /// Poses the surfaces of all jobs, on all cores. Nothing is written unless all of them are in order; buffers that
        /// overlap are not.
        fn skin_many(context: &mut Context, jobs: &mut [SkinJob]) -> Result<()>;

        /// Memory that sampling and skinning work in, used again by the next call: it saves allocations and changes no
        /// result. Keep one per character or per thread that calls; one call at a time may use it.
        type Context;

        /// Holds nothing yet; it grows as calls need.
        #[Self = "Context"]
        fn create() -> Box<Context>;

        /// A trained model: makes bodies. May be used by many threads at once, and freed before its bodies.
        type Model;

        /// The model that the library carries.
        #[Self = "Model"]
        fn embedded() -> Result<Box<Model>>;

        /// The model file that the environment variable `ANTHRONET_MODEL` names, the embedded one where it names none.
        #[Self = "Model"]
        fn from_environment() -> Result<Box<Model>>;

        /// A model file.
        #[Self = "Model"]
        fn open(path: &str) -> Result<Box<Model>>;

        /// A model from the bytes of its file, which are not needed afterwards.
        #[Self = "Model"]
        fn from_bytes(bytes: &[u8]) -> Result<Box<Model>>;

        /// What the model is, as JSON: measures with definitions and ranges, joints, versions, scores.
        fn info(self: &Model) -> String;

        /// Number of latent numbers of a body.
        fn latent_size(self: &Model) -> usize;

        /// Number of vertices of the body at a level of detail, in the model's order.
        fn vertex_count(self: &Model, lod: u32) -> Result<usize>;

        /// The smallest and largest value that a request may give of a measure, by its name with its side.
        fn measure_range(self: &Model, name: &str) -> Result<MeasureRange>;

        /// Makes the body that a request describes. It takes a while: `std::async` keeps it off the calling thread.
        fn generate(self: &Model, request: &Request) -> Result<Box<Body>>;

        /// Makes a body between two requests: `t` = 0 is the first, 1 the second; measures and identity are interpolated.
        fn interpolate(self: &Model, from: &Request, to: &Request, t: f64) -> Result<Box<Body>>;

        /// Measures a body in its bind pose at any level of detail, sculpted or not: three floats per vertex of the
        /// body alone in the model's order, metres.
        fn measure_mesh(self: &Model, positions: &[f32], space: Space) -> Result<Measured>;

        /// Measures the body of a file: .glb, .gltf, .vrm, .obj, .usd, .usda, .usdc or .usdz with the model's vertex order. Other
        /// units and axes are found from the body, and the warnings say so.
        fn measure_file(self: &Model, path: &str) -> Result<Measured>;

        /// A person to be made. Metres.
        type Request;

        /// Without given measures: the most likely person.
        #[Self = "Request"]
        fn create() -> Box<Request>;

        /// From JSON: `{"sex": "female", "measures": {"height": 1.7}, "seed": 7}`.
        #[Self = "Request"]
        fn from_json(json: &str) -> Result<Box<Request>>;

        /// A copy of it.
        fn copy(self: &Request) -> Box<Request>;

        /// In the form that `from_json` reads.
        fn to_json(self: &Request) -> String;

        /// Sets a measure, metres; a name without its side, such as `arm_length`, sets both sides.
        unsafe fn set<'a>(self: &'a mut Request, name: &str, metres: f64) -> Result<&'a mut Request>;

        /// Makes a measure not given, so that it is filled again.
        unsafe fn unset<'a>(self: &'a mut Request, name: &str) -> Result<&'a mut Request>;

        /// Sets the sex.
        unsafe fn set_sex<'a>(self: &'a mut Request, sex: Sex) -> Result<&'a mut Request>;

        /// 0 for the most likely person with these measures, any other number for another one.
        fn set_seed(self: &mut Request, seed: u64) -> &mut Request;

        /// Sets the latent numbers, as many as `Model::latent_size` says; none leaves them to the seed.
        unsafe fn set_latent<'a>(self: &'a mut Request, latent: &[f64]) -> Result<&'a mut Request>;

        /// Sets how measures that are not given are filled.
        unsafe fn set_fill<'a>(self: &'a mut Request, fill: Fill) -> Result<&'a mut Request>;

        /// Whether measures that no person has together are replaced by the nearest that a person has, with a warning in
        /// the report, or refused.
        fn set_nearest(self: &mut Request, nearest: bool) -> &mut Request;

        /// A person in the bind pose, with the report of how it was made. Immutable.
        type Body;

        /// Sex, seed, mass and how the solve went.
        fn summary(self: &Body) -> BodySummary;

        /// All measures, in the order of `measure_names`.
        fn measures(self: &Body) -> Vec<MeasureReport>;

        /// A measure of the body, by its name with its side, metres.
        fn measure(self: &Body, name: &str) -> Result<f64>;

        /// What is unusual about the body, as sentences.
        fn warnings(self: &Body) -> &[String];

        /// The whole report as JSON.
        fn report(self: &Body) -> String;

        /// The latent numbers; valid as long as the body.
        fn latent(self: &Body) -> &[f64];

        /// The joints in the bind pose, parents first.
        fn joints(self: &Body, space: Space) -> Result<Vec<Joint>>;

        /// The name of a joint in a vocabulary.
        fn joint_name(self: &Body, joint: usize, names: JointNames) -> Result<String>;

        /// Its surfaces.
        fn mesh(self: &Body, options: &MeshOptions) -> Result<Box<Mesh>>;

        /// What goes into a file.
        fn scene(self: &Body, options: &SceneOptions) -> Result<Box<Scene>>;

        /// Writes the body to a file with the defaults; see `Scene::save`.
        fn save(self: &Body, path: &str) -> Result<()>;

        /// The surfaces of a body in a space and layout. The body is the first part, then eyes, teeth, tongue, lashes.
        type Mesh;

        /// Number of parts.
        fn part_count(self: &Mesh) -> usize;

        /// A part; valid as long as the mesh.
        unsafe fn part<'a>(self: &'a Mesh, index: usize) -> Result<&'a MeshPart>;

        /// A part made ready to be posed; needs the mesh no longer.
        fn skinner(self: &Mesh, part: usize) -> Result<Box<Skinner>>;

        /// One surface with one material. Slices are valid as long as the mesh.
        type MeshPart;

        /// Such as `Body`.
        fn name(self: &MeshPart) -> &str;

        fn material(self: &MeshPart) -> Material;

        fn vertex_count(self: &MeshPart) -> usize;

        /// Influences per vertex.
        fn influences(self: &MeshPart) -> usize;

        /// Three per vertex, metres.
        fn positions(self: &MeshPart) -> &[f32];

        /// Three per vertex, unit length.
        fn normals(self: &MeshPart) -> &[f32];

        /// Two per vertex (render layout) or per texture coordinate (model layout); v grows downwards in glTF space and
        /// upwards in the others.
        fn uvs(self: &MeshPart) -> &[f32];

        /// Vertices, three per triangle. In the model layout these are the faces that are no quads: none at levels 0
        /// and 1.
        fn triangles(self: &MeshPart) -> &[u32];

        /// Texture coordinates of the triangles' corners. Model layout only.
        fn triangle_uvs(self: &MeshPart) -> &[u32];

        /// Vertices, four per quad. Model layout only.
        fn quads(self: &MeshPart) -> &[u32];

        /// Texture coordinates of the quads' corners. Model layout only.
        fn quad_uvs(self: &MeshPart) -> &[u32];

        /// Which vertex of the model each vertex is.
        fn sources(self: &MeshPart) -> &[u32];

        /// Joints, `influences` per vertex.
        fn joints(self: &MeshPart) -> &[u16];

        /// Weights, `influences` per vertex, descending, of sum 1.
        fn weights(self: &MeshPart) -> &[f32];

        /// The blend shape from this surface to that of another body, made with the same options.
        fn blend_shape(self: &MeshPart, name: &str, other: &MeshPart) -> Result<BlendShape>;

        /// A part of a mesh ready to be posed. Immutable; may be used by many threads at once.
        type Skinner;

        fn vertex_count(self: &Skinner) -> usize;

        fn joint_count(self: &Skinner) -> usize;

        /// Poses the surface: fills three floats per vertex of positions, metres, and unless it is empty of normals.
        fn skin(
            self: &Skinner,
            context: &mut Context,
            method: SkinMethod,
            pose: &[Transform],
            positions: &mut [f32],
            normals: &mut [f32],
        ) -> Result<()>;

        /// As `skin`, into one buffer as graphics cards have it: the position and normal of vertex v begin at
        /// `position_offset` and `normal_offset`, bytes, from v x `stride`; other bytes stay as they are. `offsets` are
        /// those of a `SkinJob`, or none.
        #[allow(clippy::too_many_arguments)]
        fn skin_interleaved(
            self: &Skinner,
            context: &mut Context,
            method: SkinMethod,
            pose: &[Transform],
            offsets: &[f32],
            vertices: &mut [u8],
            stride: usize,
            position_offset: usize,
            normal_offset: usize,
        ) -> Result<()>;

        /// A motion of a body's joints, frame by frame. Immutable.
        type Clip;

        /// A built-in clip for a body.
        #[Self = "Clip"]
        fn builtin(name: &str, body: &Body) -> Result<Box<Clip>>;

        fn name(self: &Clip) -> &str;

        /// The same clip with another name.
        fn renamed(self: &Clip, name: &str) -> Box<Clip>;

        fn frame_count(self: &Clip) -> usize;

        fn joint_count(self: &Clip) -> usize;

        fn frames_per_second(self: &Clip) -> f64;

        /// From the first frame to the last, seconds.
        fn duration(self: &Clip) -> f64;

        /// How a clip was retargeted, as JSON: which joint drives which, which joints drive none, errors of directions,
        /// limits and feet. Empty for other clips.
        fn report(self: &Clip) -> &str;

        /// The pose at a time: fills one transform per joint.
        fn sample(
            self: &Clip,
            context: &mut Context,
            seconds: f64,
            wrap: Wrap,
            relative: Relative,
            space: Space,
            joints: &mut [Transform],
        ) -> Result<()>;

        /// All frames in order: fills frames x joints transforms.
        fn bake(self: &Clip, relative: Relative, space: Space, joints: &mut [Transform]) -> Result<()>;

        /// The clip at another rate.
        fn resample(self: &Clip, frames_per_second: f64) -> Result<Box<Clip>>;

        /// Without root motion.
        fn in_place(self: &Clip) -> Result<Box<Clip>>;

        /// With its end blended into its beginning during the last `seconds`, so that it loops.
        fn looped(self: &Clip, seconds: f64) -> Result<Box<Clip>>;

        /// This clip blended with another of the same body: `weight` 0 is this one, 1 the other.
        fn blend(self: &Clip, other: &Clip, weight: f32) -> Result<Box<Clip>>;

        /// The mask of a part of the body, one number per joint: 1 for the joint of that name in the rig and all below
        /// it, else 0. `spine_01` is the upper body.
        fn joint_mask(self: &Clip, joint: &str) -> Result<Vec<f32>>;

        /// As `blend`, with a weight per joint: 0 is this clip, 1 is blended fully.
        fn blend_masked(self: &Clip, other: &Clip, weight: f32, mask: &[f32]) -> Result<Box<Clip>>;

        /// This clip plus the difference between `layer`, of the same body, and its first frame, times `weight`, 0 to 1.
        /// An empty mask is every joint. A layer shorter than this clip starts over.
        fn additive(self: &Clip, layer: &Clip, weight: f32, mask: &[f32]) -> Result<Box<Clip>>;

        /// This clip and then another of the same body, blended over the `seconds` by which they overlap.
        fn crossfade(self: &Clip, next: &Clip, seconds: f64) -> Result<Box<Clip>>;

        /// A motion file as it was read: at least one clip of the file's own skeleton. Immutable.
        type Motion;

        /// Reads .bvh, .fbx, .glb, .gltf, .vrm, .vrma, .npz (AMASS, SMPL-X), .usd, .usda, .usdc, .usdz.
        #[Self = "Motion"]
        fn open(path: &str, options: &MotionOptions) -> Result<Box<Motion>>;

        /// Reads a motion file from memory. `name` is the file's: its extension says the format, and a clip without a
        /// name gets it.
        #[Self = "Motion"]
        fn from_bytes(bytes: &[u8], name: &str, options: &MotionOptions) -> Result<Box<Motion>>;

        /// Number of clips.
        fn clip_count(self: &Motion) -> usize;

        unsafe fn clip_name<'a>(self: &'a Motion, clip: usize) -> Result<&'a str>;

        /// How the file was read, as JSON: format, unit, up axis, frame rate, how each was found, warnings.
        fn report(self: &Motion) -> Result<String>;

        /// Retargets one of its clips to a body. The clip's report says how sure it is that the motion is a person's
        /// (`confidence`) and why not; below 0.5 it is refused, unless joints are mapped or it is forced.
        fn retarget(self: &Motion, clip: usize, body: &Body, options: &RetargetOptions) -> Result<Box<Clip>>;

        /// A body with its clips, ready to become a file.
        type Scene;

        /// Adds a clip of the body or of one with the same rig; names are unique.
        unsafe fn add_clip<'a>(self: &'a mut Scene, clip: &Clip) -> Result<&'a mut Scene>;

        /// Writes a file in the format of its extension: .glb, .gltf (and .bin beside it), .vrm, .usda, .usdc, .usdz or
        /// .obj. It is written completely or not at all.
        fn save(self: &Scene, path: &str) -> Result<()>;

        /// The bytes of a file: `glb`, `vrm`, `usda`, `usdc`, `usdz` or `obj`.
        fn to_bytes(self: &Scene, format: &str) -> Result<Vec<u8>>;
    }
}
