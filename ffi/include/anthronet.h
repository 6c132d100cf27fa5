/* AnthroNet: people from tape measures. SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * Made from ffi/src by `cargo xtask gen`; do not edit.
 *
 * Handles. A function that makes something writes a new handle to `out_…`; free it once with the `…_free` of its kind.
 * Handles made of others do not need them any longer, in whatever order they are freed. Freeing NULL does nothing.
 *
 * Threads. What is passed as `const T*` may be used by many threads at once; what is passed as `T*` by one. A context is
 * passed as `T*`: each thread that samples or skins has its own, or passes NULL.
 *
 * Errors. Functions return ANTHRONET_OK or a code; with a code, nothing was written to any `out_…` pointer, and `error`,
 * which may be NULL, says what was wrong. Numbers that are not finite, sizes that do not fit, values that no enumeration
 * has and NULL where something is needed are refused. What no library can see is the caller's to keep: pointers point to
 * what is alive and to as much as the counts beside them say.
 *
 * Text is a pointer and a length in bytes, UTF-8, not ended by a zero, both ways. Texts have up to 1 MiB, files in memory
 * up to 1 GiB, lists up to 1,048,576 entries.
 *
 * The caller fills structures that begin with `struct_size` with zeros and sets `struct_size` to their sizeof. Zeros
 * are the defaults. NULL for a structure that is read is a structure of zeros.
 *
 * Space. Metres, radians, seconds, kilograms. Axes and handedness are those of the ANTHRONET_SPACE_… of the call.
 * Matrices are column-major and multiply column vectors; quaternions are x, y, z, w.
 */

#ifndef ANTHRONET_H
#define ANTHRONET_H

#include <stdint.h>

// The version of this interface. Raised when a caller that was compiled for an older one would misunderstand.
#define ANTHRONET_ABI_VERSION 1

// Done.
#define ANTHRONET_OK 0

// A required pointer is NULL, a pointer is not aligned, or a buffer overlaps one that the call writes.
#define ANTHRONET_ERROR_POINTER 101

// A size, count, stride or `struct_size` is not what it must be.
#define ANTHRONET_ERROR_SIZE 102

// A number is not a value of its enumeration.
#define ANTHRONET_ERROR_ENUM 103

// An index is beyond the last.
#define ANTHRONET_ERROR_INDEX 104

// A text is not UTF-8.
#define ANTHRONET_ERROR_TEXT 105

// A field of a request is unknown, not finite, or out of range.
#define ANTHRONET_ERROR_REQUEST 201

// The measures of a request cannot belong to one person.
#define ANTHRONET_ERROR_INFEASIBLE 202

// A model file is damaged or of another version.
#define ANTHRONET_ERROR_MODEL 301

// A file is damaged or not of its format.
#define ANTHRONET_ERROR_FILE 401

// The operating system refused to read or write.
#define ANTHRONET_ERROR_IO 402

// Data contradicts itself: counts that differ, numbers that are not finite, a pose of another skeleton.
#define ANTHRONET_ERROR_INVALID 501

// The job is still running.
#define ANTHRONET_ERROR_BUSY 601

// The job was cancelled before the body was made.
#define ANTHRONET_ERROR_CANCELLED 602

// The body was taken before.
#define ANTHRONET_ERROR_TAKEN 603

// Any other error.
#define ANTHRONET_ERROR_OTHER 900

// A defect of the library, caught; the message says where. Please report it.
#define ANTHRONET_ERROR_PANIC 901

// Right-handed, +Y up, the character faces +Z and has its left at +X: glTF, USD, the library's own.
#define ANTHRONET_SPACE_GLTF 0

// Right-handed, +Z up, the character faces −Y and has its left at +X: Blender. The axes of joints stay the same.
#define ANTHRONET_SPACE_BLENDER 1

// Left-handed, +Y up, the character faces +Z and has its left at −X: Unity. Triangles have the opposite
// winding, and the axes of joints are mirrored at X too.
#define ANTHRONET_SPACE_UNITY 2

// The rig's own names, such as `upperarm_l`.
#define ANTHRONET_NAMES_NATIVE 0

// Unity's `HumanBodyBones`, such as `LeftUpperArm`.
#define ANTHRONET_NAMES_UNITY 1

// Mixamo's, such as `mixamorig:LeftArm`.
#define ANTHRONET_NAMES_MIXAMO 2

// VRM 1.0's, such as `leftUpperArm`.
#define ANTHRONET_NAMES_VRM 3

// Blender's, such as `upper_arm.L`.
#define ANTHRONET_NAMES_BLENDER 4

// Linear blend skinning: what glTF, UsdSkel and game engines do.
#define ANTHRONET_SKIN_LINEAR 0

// Dual quaternions: Blender's "Preserve Volume".
#define ANTHRONET_SKIN_DUAL_QUATERNION 1

// The paper's formula: joints move vertices but do not turn them.
#define ANTHRONET_SKIN_JOINT_TRANSLATION 2

// Information.
#define ANTHRONET_LOG_INFO 0

// A warning: a result may not be as intended.
#define ANTHRONET_LOG_WARNING 1

// A defect that no call could return.
#define ANTHRONET_LOG_ERROR 2

// Inferred from the measures.
#define ANTHRONET_SEX_ANY 0

// Female.
#define ANTHRONET_SEX_FEMALE 1

// Male.
#define ANTHRONET_SEX_MALE 2

// Measures that are not given get their most likely values, given the others.
#define ANTHRONET_FILL_MEAN 0

// Measures that are not given are drawn from their distribution, given the others; the seed chooses.
#define ANTHRONET_FILL_SAMPLE 1

// Bodies are still being made.
#define ANTHRONET_JOB_RUNNING 0

// Every request has its body or its error.
#define ANTHRONET_JOB_DONE 1

// Cancelled, and nothing is running any more; what was made before can be taken.
#define ANTHRONET_JOB_CANCELLED 2

// One texture coordinate per vertex (vertices at seams are doubled) and triangles only: for drawing.
#define ANTHRONET_LAYOUT_RENDER 0

// The model's own vertices and quads, texture coordinates per corner: for editing and measuring.
#define ANTHRONET_LAYOUT_MODEL 1

// float × 3 per vertex, metres.
#define ANTHRONET_ATTRIBUTE_POSITIONS 0

// float × 3 per vertex, unit length.
#define ANTHRONET_ATTRIBUTE_NORMALS 1

// float × 2 per vertex (render layout) or per texture coordinate (model layout); v grows downwards in glTF space and
// upwards in the others.
#define ANTHRONET_ATTRIBUTE_UVS 2

// uint32 × 3 per triangle: vertices. In the model layout these are the faces that are not quads: none at levels 0 and 1.
#define ANTHRONET_ATTRIBUTE_TRIANGLES 3

// uint16 × influences per vertex: joints.
#define ANTHRONET_ATTRIBUTE_JOINTS 4

// float × influences per vertex: weights, descending, of sum 1.
#define ANTHRONET_ATTRIBUTE_WEIGHTS 5

// uint32 per vertex: which vertex of the model it is.
#define ANTHRONET_ATTRIBUTE_SOURCES 6

// uint32 × 4 per quad: vertices. Model layout only.
#define ANTHRONET_ATTRIBUTE_QUADS 7

// uint32 × 4 per quad: texture coordinates of its corners. Model layout only.
#define ANTHRONET_ATTRIBUTE_QUAD_UVS 8

// uint32 × 3 per triangle: texture coordinates of its corners. Model layout only.
#define ANTHRONET_ATTRIBUTE_TRIANGLE_UVS 9

// 32-bit floats.
#define ANTHRONET_TYPE_F32 0

// 32-bit unsigned integers.
#define ANTHRONET_TYPE_U32 1

// 16-bit unsigned integers.
#define ANTHRONET_TYPE_U16 2

// The clip holds its first or last frame outside its duration.
#define ANTHRONET_WRAP_ONCE 0

// The clip starts over; its last frame is its first.
#define ANTHRONET_WRAP_LOOP 1

// As `ANTHRONET_WRAP_LOOP` with root motion: every cycle continues where the last one ended.
#define ANTHRONET_WRAP_ROOT_MOTION 2

// Each joint relative to its parent: what animation tracks hold.
#define ANTHRONET_RELATIVE_TO_PARENT 0

// Each joint relative to the model: what skinning takes.
#define ANTHRONET_RELATIVE_TO_MODEL 1

// Fingers of the motion where it has any, else relaxed.
#define ANTHRONET_FINGERS_SOURCE 0

// Relaxed hands.
#define ANTHRONET_FINGERS_RELAXED 1

// Fingers as in the bind pose.
#define ANTHRONET_FINGERS_REST 2

// As the file says, or else found from the proportions of its skeleton.
#define ANTHRONET_UP_FOUND 0

// +Y points up in the file.
#define ANTHRONET_UP_Y 1

// +Z points up in the file.
#define ANTHRONET_UP_Z 2

// +X points up in the file.
#define ANTHRONET_UP_X 3

// +X points down in the file.
#define ANTHRONET_UP_NEGATIVE_X 4

// +Y points down in the file, as in the axes of cameras.
#define ANTHRONET_UP_NEGATIVE_Y 5

// +Z points down in the file.
#define ANTHRONET_UP_NEGATIVE_Z 6

// A person in the bind pose, with the report of how it was made. Immutable.
typedef struct anthronet_body anthronet_body;

// Bytes that the library made: a file in memory, or JSON as UTF-8.
typedef struct anthronet_bytes anthronet_bytes;

// A motion of a body's joints, frame by frame. Immutable.
typedef struct anthronet_clip anthronet_clip;

// Memory that sampling and skinning work in, used again by the next call: it saves allocations and changes no result. Keep
// one per character or per thread that calls; one call at a time may use it. It grows as calls need and is freed as a
// whole. Where a function takes one, NULL stands for memory that is made for the call.
typedef struct anthronet_context anthronet_context;

// Requests that are being made into bodies by a thread of the library. May be polled and cancelled from any thread.
typedef struct anthronet_job anthronet_job;

// The surfaces of a body in a space and layout.
typedef struct anthronet_mesh anthronet_mesh;

// A trained model: makes bodies. Immutable; may be used by many threads at once.
typedef struct anthronet_model anthronet_model;

// A motion file as it was read: at least one clip of the file's own skeleton. Immutable.
typedef struct anthronet_motion anthronet_motion;

// A person to be made. One thread at a time may change it.
typedef struct anthronet_request anthronet_request;

// A part of a mesh ready to be posed. Immutable; may be used by many threads and jobs at once.
typedef struct anthronet_skinner anthronet_skinner;

// What every call that can fail returns: `ANTHRONET_OK` or one of `ANTHRONET_ERROR_…`.
typedef int32_t anthronet_status;

// A text that the library owns: UTF-8, not ended by a zero, valid as long as the object that it was read from.
typedef struct anthronet_text {
    // The first byte.
    const char *data;
    // Number of bytes.
    uint64_t length;
} anthronet_text;

// What went wrong. The caller's own; may be NULL in every call. Written only on failure.
typedef struct anthronet_error {
    // The status that the call returned.
    int32_t code;
    // A sentence in English, UTF-8, ended by a zero; longer ones are cut.
    char message[512];
} anthronet_error;

// Receives a message: its level, `length` bytes of UTF-8 that are valid only during the call, and the `user` pointer of
// the callback. Called from any thread, one call at a time; it must not call the library.
typedef void (*anthronet_log_callback)(uint32_t level, const char *message, uint64_t length, void *user);

// Mass and volume of a measured mesh.
typedef struct anthronet_measured {
    // Set by the caller: `sizeof(anthronet_measured)`.
    uint32_t struct_size;
    // The level of detail of the mesh, recognised by its number of vertices.
    uint32_t lod;
    // Mass, kg.
    double mass_kg;
    // Volume, m³.
    double volume_m3;
    // Body mass index, kg/m².
    double bmi;
} anthronet_measured;

// One measure of a body. Metres.
typedef struct anthronet_measure_report {
    // The value in the request; 0 for a filled measure.
    double asked;
    // The value of the body.
    double obtained;
    // Obtained − asked; 0 for a filled measure.
    double residual;
    // Lower end of what 90 % of people with the given measures have; the value itself for a given measure.
    double low90;
    // Upper end of that interval.
    double high90;
    // Share of people of this sex, 0 to 100, who have at most the obtained value.
    double percentile;
    // 1 if the request gives it, else 0.
    uint32_t given;
    // How a measure that is not given was filled: `ANTHRONET_FILL_…`; 0 for a given one.
    uint32_t filled;
} anthronet_measure_report;

// A body in numbers.
typedef struct anthronet_body_summary {
    // Set by the caller: `sizeof(anthronet_body_summary)`.
    uint32_t struct_size;
    // `ANTHRONET_SEX_FEMALE` or `ANTHRONET_SEX_MALE`.
    uint32_t sex;
    // The request's seed.
    uint64_t seed;
    // Mass, kg.
    double mass_kg;
    // Volume, m³.
    double volume_m3;
    // Body mass index, kg/m².
    double bmi;
    // Largest |obtained − asked| over the given measures, metres.
    double solve_residual;
    // Steps of the exact solve.
    uint32_t iterations;
    // 1 if the solve met its tolerance.
    uint32_t converged;
    // Number of joints.
    uint32_t joint_count;
    // Number of warnings in the report.
    uint32_t warning_count;
} anthronet_body_summary;

// Progress of a job.
typedef struct anthronet_job_progress {
    // Set by the caller: `sizeof(anthronet_job_progress)`.
    uint32_t struct_size;
    // `ANTHRONET_JOB_…`.
    uint32_t state;
    // Requests that have their body or error.
    uint32_t done;
    // Requests altogether.
    uint32_t total;
} anthronet_job_progress;

// Where a joint is, relative to its parent or to the model: a rotation, then a translation.
typedef struct anthronet_transform {
    // Unit quaternion x, y, z, w.
    float rotation[4];
    // Metres.
    float translation[3];
} anthronet_transform;

// A joint in the bind pose. Its +Y axis runs along its bone in every space. Matrices are column-major and multiply column vectors.
typedef struct anthronet_joint {
    // Place of the parent, before this joint's own; −1 of the root.
    int32_t parent;
    // From the joint along its +Y axis to where its bone ends, metres.
    float length;
    // Relative to the parent.
    struct anthronet_transform parent_from_joint;
    // From the joint's space to the model's.
    float model_from_joint[16];
    // The inverse bind matrix.
    float joint_from_model[16];
} anthronet_joint;

// A joint that is a bone of the standard humanoid, with its name in every vocabulary. All texts stay valid.
typedef struct anthronet_humanoid_bone {
    // Set by the caller: `sizeof(anthronet_humanoid_bone)`.
    uint32_t struct_size;
    // 1 if Unity and VRM 1.0 require it.
    uint32_t required;
    // Name in the rig.
    struct anthronet_text native;
    // Member of Unity's `HumanBodyBones`.
    struct anthronet_text unity;
    // Name in Unity's `HumanTrait.BoneName`.
    struct anthronet_text unity_trait;
    // Name in files from Mixamo.
    struct anthronet_text mixamo;
    // Key in VRM 1.0's `humanBones`.
    struct anthronet_text vrm;
    // Name in Blender.
    struct anthronet_text blender;
} anthronet_humanoid_bone;

// How a mesh is made of a body; all zeros are the defaults.
typedef struct anthronet_mesh_options {
    // Set by the caller: `sizeof(anthronet_mesh_options)`.
    uint32_t struct_size;
    // Level of detail, 0 (finest) to 3.
    uint32_t lod;
    // Influences per vertex, 4 or 8; 0 stands for 4.
    uint32_t influences;
    // `ANTHRONET_SPACE_…` of all that is read from the mesh.
    uint32_t space;
    // `ANTHRONET_LAYOUT_…`.
    uint32_t layout;
    // 1 leaves out eyes, teeth, tongue and lashes.
    uint32_t body_only;
    // Step of the Monk skin tone scale, 1 to 10; 0 for the default tone.
    uint32_t skin_tone;
} anthronet_mesh_options;

// A part of a mesh: one surface with one material. The body is the first.
typedef struct anthronet_mesh_part {
    // Set by the caller: `sizeof(anthronet_mesh_part)`.
    uint32_t struct_size;
    // Number of vertices.
    uint32_t vertex_count;
    // Number of texture coordinates.
    uint32_t uv_count;
    // Number of triangles.
    uint32_t triangle_count;
    // Number of quads; 0 in the render layout.
    uint32_t quad_count;
    // Influences per vertex.
    uint32_t influences;
    // 1 if back faces are drawn too.
    uint32_t double_sided;
    // Perceptual roughness of the material, 0 to 1.
    float roughness;
    // Colour of the material: linear red, green, blue and alpha.
    float base_color[4];
    // Its name, such as `Body`; valid as long as the mesh.
    struct anthronet_text name;
} anthronet_mesh_part;

// An array of a mesh.
typedef struct anthronet_view {
    // The first number; packed rows follow. NULL for an empty array. Valid until the mesh is updated or freed.
    const void *data;
    // Number of rows.
    uint64_t rows;
    // Numbers per row.
    uint32_t columns;
    // `ANTHRONET_TYPE_…` of the numbers.
    uint32_t number_type;
} anthronet_view;

// A clip in numbers.
typedef struct anthronet_clip_info {
    // Set by the caller: `sizeof(anthronet_clip_info)`.
    uint32_t struct_size;
    // Number of frames.
    uint32_t frame_count;
    // Number of joints.
    uint32_t joint_count;
    // 0; fills the structure up.
    uint32_t reserved;
    // Frames per second.
    double frames_per_second;
    // From the first frame to the last, seconds.
    double duration;
    // Its name; valid as long as the clip.
    struct anthronet_text name;
} anthronet_clip_info;

// How a motion file is read; these values override those in the file. Zeros leave everything to the file.
typedef struct anthronet_motion_options {
    // Set by the caller: `sizeof(anthronet_motion_options)`.
    uint32_t struct_size;
    // `ANTHRONET_UP_…`.
    uint32_t up;
    // Metres per unit of length, such as 0.01.
    double metres_per_unit;
    // Frames per second: frames were recorded at this rate, curves are sampled at it.
    double frames_per_second;
    // Which of several people in an `.npz`, from 1; 0 reads the first, with a warning.
    uint32_t person;
} anthronet_motion_options;

// A motion of a skeleton of another program, such as an action of an armature. Arrays are read only during the call.
typedef struct anthronet_motion_source {
    // Set by the caller: `sizeof(anthronet_motion_source)`.
    uint32_t struct_size;
    // `ANTHRONET_SPACE_…` of the transforms; lengths are metres.
    uint32_t space;
    // Number of joints.
    uint32_t joint_count;
    // Number of frames.
    uint32_t frame_count;
    // Frames per second.
    double frames_per_second;
    // Name of the clip.
    struct anthronet_text name;
    // Name of each joint; none twice.
    const struct anthronet_text *joint_names;
    // Place of each joint's parent, before the joint's own; −1 for none.
    const int32_t *parents;
    // Where each joint rests, relative to its parent.
    const struct anthronet_transform *rest;
    // Frame by frame, each joint relative to its parent: frames × joints.
    const struct anthronet_transform *frames;
} anthronet_motion_source;

// How a motion is retargeted to a body; all zeros are the defaults.
typedef struct anthronet_retarget_options {
    // Set by the caller: `sizeof(anthronet_retarget_options)`.
    uint32_t struct_size;
    // `ANTHRONET_FINGERS_…`.
    uint32_t fingers;
    // 1 does not keep joints within the limits of human joints.
    uint32_t no_limits;
    // 1 does not keep feet that touch the floor from sliding and sinking in.
    uint32_t no_feet;
    // 1 removes root motion.
    uint32_t in_place;
    // 1 blends the end into the beginning, so that the clip loops.
    uint32_t looped;
    // 1 puts root motion on the joint `Root` instead of the pelvis.
    uint32_t root_motion;
    // Bytes of `mapping_json`.
    uint32_t mapping_length;
    // Which joint of the motion drives which joint of the rig, or none, as JSON: `{"LeftArm": "upperarm_l", "Tail": null}`;
    // joints that it does not name are matched automatically. NULL matches all of them.
    const char *mapping_json;
    // Frames per second of the result; 0 keeps those of the motion.
    double frames_per_second;
    // 1 accepts a motion that seems to be no person's, or in which nobody stands.
    uint32_t force;
} anthronet_retarget_options;

// One surface to pose. Everything is in the space of the mesh that the skinner was made of.
typedef struct anthronet_skin_job {
    // Set by the caller: `sizeof(anthronet_skin_job)`; in a list of jobs alike in all.
    uint32_t struct_size;
    // `ANTHRONET_SKIN_…`.
    uint32_t method;
    // The surface.
    const struct anthronet_skinner *skinner;
    // The pose: every joint relative to the model, as `anthronet_clip_sample` fills it.
    const struct anthronet_transform *joints;
    // Number of joints.
    uint32_t joint_count;
    // Number of `offsets`: 0, or one per vertex.
    uint32_t offset_count;
    // Three floats per vertex, added to the bind positions before they are posed (correctives), metres; or NULL.
    const float *offsets;
    // Where three floats per vertex are written, metres.
    void *positions;
    // Bytes of that buffer.
    uint64_t position_bytes;
    // Bytes from position to position; 0 for packed.
    uint64_t position_stride;
    // Where unit normals are written, three floats per vertex; NULL for nowhere. In the buffer of the positions, as
    // vertex buffers are laid out, it points at the first normal, less than the one stride of both from the first
    // position.
    void *normals;
    // Bytes of that buffer.
    uint64_t normal_bytes;
    // Bytes from normal to normal; 0 for packed.
    uint64_t normal_stride;
} anthronet_skin_job;

// How a body is written to a file; all zeros are the defaults.
typedef struct anthronet_export_options {
    // Set by the caller: `sizeof(anthronet_export_options)`.
    uint32_t struct_size;
    // Level of detail, 0 (finest) to 3.
    uint32_t lod;
    // Influences per vertex, 4 or 8; 0 stands for 4.
    uint32_t influences;
    // Names of the joints: `ANTHRONET_NAMES_…`.
    uint32_t joint_names;
    // 1 leaves out eyes, teeth, tongue and lashes.
    uint32_t body_only;
    // Step of the Monk skin tone scale, 1 to 10; 0 for the default tone.
    uint32_t skin_tone;
    // 1 compresses .glb and .gltf (EXT_meshopt_compression).
    uint32_t compress;
    // Number of `clips`.
    uint32_t clip_count;
    // Clips of this body or one of the same rig that go into the file; NULL for none. Their names are unique.
    const struct anthronet_clip *const *clips;
    // Name of the pose in which the file stands, UTF-8: `t-pose`, `a-pose`, `standing` or `sitting`; NULL for the T-pose, the
    // only one of a .vrm. Files with joints stay bound in the T-pose.
    const char *pose;
    // Bytes of `pose`.
    uint64_t pose_length;
} anthronet_export_options;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The `ANTHRONET_ABI_VERSION` that the library was compiled with; a caller that was compiled with another one must
// stop.
uint32_t anthronet_abi_version(void);

// The version of the library, such as `0.1.0`; always valid.
anthronet_status anthronet_version(struct anthronet_text *out_version, struct anthronet_error *error);

// Sets the callback that receives messages; NULL for none, which is the default. When it returns, the former callback is not running
// and will not be called again. `user` is handed to every call.
anthronet_status anthronet_set_log_callback(anthronet_log_callback callback,
                                            void *user,
                                            struct anthronet_error *error);

// Where the bytes are, and how many; valid until they are freed.
anthronet_status anthronet_bytes_data(const struct anthronet_bytes *bytes,
                                      const uint8_t **out_data,
                                      uint64_t *out_length,
                                      struct anthronet_error *error);

// Frees bytes; NULL is nothing.
void anthronet_bytes_free(struct anthronet_bytes *bytes);

// Opens the model that the library carries.
anthronet_status anthronet_model_open_embedded(struct anthronet_model **out_model, struct anthronet_error *error);

// Opens the model file that the environment variable `ANTHRONET_MODEL` names, and the embedded one where it names
// none.
anthronet_status anthronet_model_open_default(struct anthronet_model **out_model, struct anthronet_error *error);

// Opens a model file.
anthronet_status anthronet_model_open_path(const char *path,
                                           uint64_t path_length,
                                           struct anthronet_model **out_model,
                                           struct anthronet_error *error);

// Opens a model from the bytes of its file, which are not needed afterwards.
anthronet_status anthronet_model_open_memory(const uint8_t *data,
                                             uint64_t length,
                                             struct anthronet_model **out_model,
                                             struct anthronet_error *error);

// Frees a model; NULL is nothing. Bodies and jobs made by it stay whole.
void anthronet_model_free(struct anthronet_model *model);

// What the model is, as JSON: measures with definitions and ranges, joints, versions, scores.
anthronet_status anthronet_model_info(const struct anthronet_model *model,
                                      struct anthronet_bytes **out_json,
                                      struct anthronet_error *error);

// Number of latent numbers of a body.
anthronet_status anthronet_model_latent_size(const struct anthronet_model *model,
                                             uint32_t *out_size,
                                             struct anthronet_error *error);

// Number of vertices of the body at a level of detail, 0 to 3, in the model's order.
anthronet_status anthronet_model_vertex_count(const struct anthronet_model *model,
                                              uint32_t level,
                                              uint32_t *out_count,
                                              struct anthronet_error *error);

// The smallest and largest value that a request may give of a measure, metres.
anthronet_status anthronet_model_measure_range(const struct anthronet_model *model,
                                               uint32_t measure,
                                               double *out_min,
                                               double *out_max,
                                               struct anthronet_error *error);

// Number of measures.
uint32_t anthronet_measure_count(void);

// The name of a measure, such as `waist_circumference`; always valid.
anthronet_status anthronet_measure_name(uint32_t measure,
                                        struct anthronet_text *out_name,
                                        struct anthronet_error *error);

// The place of a measure by its name, with its side.
anthronet_status anthronet_measure_index(const char *name,
                                         uint64_t name_length,
                                         uint32_t *out_measure,
                                         struct anthronet_error *error);

// Measures a body in its bind pose at any level of detail, sculpted or not: `positions` are the vertices of the body
// alone in the model's order, three floats each, `stride` bytes apart (0: packed), metres, in `from_space`. Fills
// `count` measures, as many as `anthronet_measure_count` says, metres; `out_measured` may be NULL.
anthronet_status anthronet_measure_mesh(const struct anthronet_model *model,
                                        const void *positions,
                                        uint32_t vertex_count,
                                        uint64_t stride,
                                        uint32_t from_space,
                                        double *out_metres,
                                        uint32_t count,
                                        struct anthronet_measured *out_measured,
                                        struct anthronet_error *error);

// Measures the body of a file: .glb, .gltf, .vrm, .obj, .usd, .usda, .usdc or .usdz with the model's vertex order. Results as
// of `anthronet_measure_mesh`. Other units and axes are found from the body, which is logged as a warning.
anthronet_status anthronet_measure_file(const struct anthronet_model *model,
                                        const char *path,
                                        uint64_t path_length,
                                        double *out_metres,
                                        uint32_t count,
                                        struct anthronet_measured *out_measured,
                                        struct anthronet_error *error);

// Measures the body of a file as `anthronet_measure_file` does, as JSON: `{"measures": [{"name", "value"}, …], "mass_kg",
// "volume_m3", "bmi", "lod", "warnings"}`; metres. The warnings say in which unit and axes the file was read, if not in metres
// with +Y up.
anthronet_status anthronet_measure_file_report(const struct anthronet_model *model,
                                               const char *path,
                                               uint64_t path_length,
                                               struct anthronet_bytes **out_json,
                                               struct anthronet_error *error);

// A request without given measures: the most likely person.
anthronet_status anthronet_request_new(struct anthronet_request **out_request, struct anthronet_error *error);

// A request from JSON: `{"sex": "female", "measures": {"height": 1.7}, "seed": 7}`; metres.
anthronet_status anthronet_request_from_json(const char *json,
                                             uint64_t json_length,
                                             struct anthronet_request **out_request,
                                             struct anthronet_error *error);

// A copy of a request.
anthronet_status anthronet_request_copy(const struct anthronet_request *request,
                                        struct anthronet_request **out_request,
                                        struct anthronet_error *error);

// Frees a request; NULL is nothing.
void anthronet_request_free(struct anthronet_request *request);

// The request as JSON, in the form that `anthronet_request_from_json` reads.
anthronet_status anthronet_request_to_json(const struct anthronet_request *request,
                                           struct anthronet_bytes **out_json,
                                           struct anthronet_error *error);

// Sets the sex: `ANTHRONET_SEX_…`.
anthronet_status anthronet_request_set_sex(struct anthronet_request *request,
                                           uint32_t sex,
                                           struct anthronet_error *error);

// Sets a measure by its name, metres; a name without its side, such as `arm_length`, sets both sides.
anthronet_status anthronet_request_set_measure(struct anthronet_request *request,
                                               const char *name,
                                               uint64_t name_length,
                                               double metres,
                                               struct anthronet_error *error);

// Sets or unsets all measures at once: `metres` and `given` (0 or 1) have one entry per measure in the order of
// `anthronet_measure_name`; `count` is their number. `metres` of a measure that is not given is ignored.
anthronet_status anthronet_request_set_measures(struct anthronet_request *request,
                                                const double *metres,
                                                const uint8_t *given,
                                                uint32_t count,
                                                struct anthronet_error *error);

// The given measures: fills `out_metres` (0 for a measure that is not given) and `out_given`, `count` entries each, one per measure.
anthronet_status anthronet_request_measures(const struct anthronet_request *request,
                                            double *out_metres,
                                            uint8_t *out_given,
                                            uint32_t count,
                                            struct anthronet_error *error);

// Makes a measure not given, so that it is filled again; by its place in the order of `anthronet_measure_name`.
anthronet_status anthronet_request_unset_measure(struct anthronet_request *request,
                                                 uint32_t measure,
                                                 struct anthronet_error *error);

// Sets the seed: 0 for the most likely person with these measures, any other number for another one.
anthronet_status anthronet_request_set_seed(struct anthronet_request *request,
                                            uint64_t seed,
                                            struct anthronet_error *error);

// Sets the latent numbers, as many as `anthronet_model_latent_size` says; none (`count` 0) leaves them to the seed.
anthronet_status anthronet_request_set_latent(struct anthronet_request *request,
                                              const double *latent,
                                              uint32_t count,
                                              struct anthronet_error *error);

// Sets how measures that are not given are filled: `ANTHRONET_FILL_…`.
anthronet_status anthronet_request_set_fill(struct anthronet_request *request,
                                            uint32_t fill,
                                            struct anthronet_error *error);

// Whether measures that no person has together are replaced by the nearest that a person has (1), with a warning in the
// report, or refused (0).
anthronet_status anthronet_request_set_nearest(struct anthronet_request *request,
                                               uint32_t nearest,
                                               struct anthronet_error *error);

// Makes the body that a request describes.
anthronet_status anthronet_generate(const struct anthronet_model *model,
                                    const struct anthronet_request *request,
                                    struct anthronet_body **out_body,
                                    struct anthronet_error *error);

// Makes a body between two requests: `t` = 0 is the first, 1 the second; measures and identity are interpolated.
anthronet_status anthronet_interpolate(const struct anthronet_model *model,
                                       const struct anthronet_request *from,
                                       const struct anthronet_request *to,
                                       double t,
                                       struct anthronet_body **out_body,
                                       struct anthronet_error *error);

// Frees a body; NULL is nothing. What was made of it stays whole.
void anthronet_body_free(struct anthronet_body *body);

// The report as JSON: `{"measures": [{"name", "asked", "obtained", …}], "warnings", "conflicts", "seed", …}`; metres.
anthronet_status anthronet_body_report(const struct anthronet_body *body,
                                       struct anthronet_bytes **out_json,
                                       struct anthronet_error *error);

// The report's measures: fills `count` entries, one per measure, in the order of `anthronet_measure_name`.
anthronet_status anthronet_body_measures(const struct anthronet_body *body,
                                         struct anthronet_measure_report *out_measures,
                                         uint32_t count,
                                         struct anthronet_error *error);

// Sex, seed, mass and how the solve went.
anthronet_status anthronet_body_summarise(const struct anthronet_body *body,
                                          struct anthronet_body_summary *out_summary,
                                          struct anthronet_error *error);

// The latent numbers of the body: fills `count` entries, as many as `anthronet_model_latent_size` says.
anthronet_status anthronet_body_latent(const struct anthronet_body *body,
                                       double *out_latent,
                                       uint32_t count,
                                       struct anthronet_error *error);

// Starts to make the bodies of `count` requests, in order. The requests are copied and the model is kept: both may be
// freed.
anthronet_status anthronet_job_start(const struct anthronet_model *model,
                                     const struct anthronet_request *const *requests,
                                     uint32_t count,
                                     struct anthronet_job **out_job,
                                     struct anthronet_error *error);

// The progress of the job. Returns at once.
anthronet_status anthronet_job_poll(const struct anthronet_job *job,
                                    struct anthronet_job_progress *out_progress,
                                    struct anthronet_error *error);

// Asks the job to stop after the current body, which takes some hundredths of a second at most. Returns at once.
anthronet_status anthronet_job_cancel(const struct anthronet_job *job, struct anthronet_error *error);

// Takes the body of a request, once, as soon as it is there; while the job goes on, too. Fails with the error of that
// request, with `ANTHRONET_ERROR_BUSY` before there is one, with `ANTHRONET_ERROR_CANCELLED` when there will be none.
anthronet_status anthronet_job_take(const struct anthronet_job *job,
                                    uint32_t index,
                                    struct anthronet_body **out_body,
                                    struct anthronet_error *error);

// Cancels the job, waits until it has stopped and frees it; NULL is nothing.
void anthronet_job_free(struct anthronet_job *job);

// The joints of a body in the bind pose, parents first: fills `count` entries, as many as
// `anthronet_body_summary.joint_count` says.
anthronet_status anthronet_body_joints(const struct anthronet_body *body,
                                       uint32_t in_space,
                                       struct anthronet_joint *out_joints,
                                       uint32_t count,
                                       struct anthronet_error *error);

// The name of a joint of a body in a vocabulary, `ANTHRONET_NAMES_…`; valid as long as the body.
anthronet_status anthronet_body_joint_name(const struct anthronet_body *body,
                                           uint32_t joint,
                                           uint32_t names,
                                           struct anthronet_text *out_name,
                                           struct anthronet_error *error);

// Number of humanoid bones: 55.
uint32_t anthronet_humanoid_bone_count(void);

// A humanoid bone.
anthronet_status anthronet_humanoid_bone_at(uint32_t index,
                                            struct anthronet_humanoid_bone *out_bone,
                                            struct anthronet_error *error);

// Makes the meshes of a body; `options` may be NULL.
anthronet_status anthronet_mesh_new(const struct anthronet_body *body,
                                    const struct anthronet_mesh_options *options,
                                    struct anthronet_mesh **out_mesh,
                                    struct anthronet_error *error);

// Changes the mesh to that of another body, with the same options and without blend shapes. Earlier views become
// invalid.
anthronet_status anthronet_mesh_update(struct anthronet_mesh *mesh,
                                       const struct anthronet_body *body,
                                       struct anthronet_error *error);

// Frees a mesh; NULL is nothing.
void anthronet_mesh_free(struct anthronet_mesh *mesh);

// Number of parts: the body, then eyes and, at levels 0 and 1, teeth, tongue and lashes.
anthronet_status anthronet_mesh_part_count(const struct anthronet_mesh *mesh,
                                           uint32_t *out_count,
                                           struct anthronet_error *error);

// Describes a part.
anthronet_status anthronet_mesh_describe_part(const struct anthronet_mesh *mesh,
                                              uint32_t part,
                                              struct anthronet_mesh_part *out_part,
                                              struct anthronet_error *error);

// Where an array of a part is, `attribute` one of `ANTHRONET_ATTRIBUTE_…`.
anthronet_status anthronet_mesh_data(const struct anthronet_mesh *mesh,
                                     uint32_t part,
                                     uint32_t attribute,
                                     struct anthronet_view *out_view,
                                     struct anthronet_error *error);

// Copies an array of a part to a buffer of `buffer_bytes` bytes, `stride` bytes from row to row (0: packed). Bytes
// between the rows stay as they are.
anthronet_status anthronet_mesh_read(const struct anthronet_mesh *mesh,
                                     uint32_t part,
                                     uint32_t attribute,
                                     void *out_rows,
                                     uint64_t buffer_bytes,
                                     uint64_t stride,
                                     struct anthronet_error *error);

// Adds a blend shape from the mesh to the surface of another body: at weight 1 the mesh has that body's shape in the bind
// pose. Joints stay where they are, so bodies should be of about the same stature.
anthronet_status anthronet_mesh_add_blend_shape(struct anthronet_mesh *mesh,
                                                const char *name,
                                                uint64_t name_length,
                                                const struct anthronet_body *body,
                                                struct anthronet_error *error);

// Number of blend shapes.
anthronet_status anthronet_mesh_blend_shape_count(const struct anthronet_mesh *mesh,
                                                  uint32_t *out_count,
                                                  struct anthronet_error *error);

// The name of a blend shape; valid until the mesh is updated or freed.
anthronet_status anthronet_mesh_blend_shape_name(const struct anthronet_mesh *mesh,
                                                 uint32_t shape,
                                                 struct anthronet_text *out_name,
                                                 struct anthronet_error *error);

// Where the displacements of a part are: `attribute` is `ANTHRONET_ATTRIBUTE_POSITIONS` or `ANTHRONET_ATTRIBUTE_NORMALS`, three
// floats per vertex, to be added to those of the mesh.
anthronet_status anthronet_mesh_blend_shape_data(const struct anthronet_mesh *mesh,
                                                 uint32_t shape,
                                                 uint32_t part,
                                                 uint32_t attribute,
                                                 struct anthronet_view *out_view,
                                                 struct anthronet_error *error);

// Copies the displacements of a part to a buffer, as `anthronet_mesh_read` does.
anthronet_status anthronet_mesh_read_blend_shape(const struct anthronet_mesh *mesh,
                                                 uint32_t shape,
                                                 uint32_t part,
                                                 uint32_t attribute,
                                                 void *out_rows,
                                                 uint64_t buffer_bytes,
                                                 uint64_t stride,
                                                 struct anthronet_error *error);

// Makes a context, which holds nothing yet.
anthronet_status anthronet_context_new(struct anthronet_context **out_context, struct anthronet_error *error);

// Frees a context; NULL is nothing.
void anthronet_context_free(struct anthronet_context *context);

// Number of built-in clips.
uint32_t anthronet_clip_builtin_count(void);

// The name of a built-in clip, such as `walk`; always valid.
anthronet_status anthronet_clip_builtin_name(uint32_t index,
                                             struct anthronet_text *out_name,
                                             struct anthronet_error *error);

// Makes a built-in clip for a body.
anthronet_status anthronet_clip_builtin(const char *name,
                                        uint64_t name_length,
                                        const struct anthronet_body *body,
                                        struct anthronet_clip **out_clip,
                                        struct anthronet_error *error);

// Makes a clip from poses of a body, such as an action of its armature: `frames` holds, frame by frame, every joint
// relative to its parent in `in_space`; `count` = frames × joints.
anthronet_status anthronet_clip_from_poses(const struct anthronet_body *body,
                                           const char *name,
                                           uint64_t name_length,
                                           double frames_per_second,
                                           uint32_t in_space,
                                           const struct anthronet_transform *frames,
                                           uint64_t count,
                                           struct anthronet_clip **out_clip,
                                           struct anthronet_error *error);

// Frees a clip; NULL is nothing.
void anthronet_clip_free(struct anthronet_clip *clip);

// Describes a clip.
anthronet_status anthronet_clip_describe(const struct anthronet_clip *clip,
                                         struct anthronet_clip_info *out_info,
                                         struct anthronet_error *error);

// The pose of a clip at a time, from −1e9 to 1e9 seconds: fills `count` joints. `wrap` is `ANTHRONET_WRAP_…`, `relative`
// `ANTHRONET_RELATIVE_TO_…`; `context` may be NULL.
anthronet_status anthronet_clip_sample(const struct anthronet_clip *clip,
                                       struct anthronet_context *context,
                                       double seconds,
                                       uint32_t wrap,
                                       uint32_t relative,
                                       uint32_t in_space,
                                       struct anthronet_transform *out_joints,
                                       uint32_t count,
                                       struct anthronet_error *error);

// All frames of a clip in order: fills `count` = frames × joints transforms.
anthronet_status anthronet_clip_bake(const struct anthronet_clip *clip,
                                     uint32_t relative,
                                     uint32_t in_space,
                                     struct anthronet_transform *out_joints,
                                     uint64_t count,
                                     struct anthronet_error *error);

// The clip at another rate, frames per second.
anthronet_status anthronet_clip_resample(const struct anthronet_clip *clip,
                                         double frames_per_second,
                                         struct anthronet_clip **out_clip,
                                         struct anthronet_error *error);

// The clip without root motion.
anthronet_status anthronet_clip_in_place(const struct anthronet_clip *clip,
                                         struct anthronet_clip **out_clip,
                                         struct anthronet_error *error);

// The clip with its end blended into its beginning during the last `seconds`, so that it loops.
anthronet_status anthronet_clip_looped(const struct anthronet_clip *clip,
                                       double seconds,
                                       struct anthronet_clip **out_clip,
                                       struct anthronet_error *error);

// Blends two clips of one body: `weight` 0 is the first, 1 the second.
anthronet_status anthronet_clip_blend(const struct anthronet_clip *first,
                                      const struct anthronet_clip *second,
                                      float weight,
                                      struct anthronet_clip **out_clip,
                                      struct anthronet_error *error);

// As `anthronet_clip_blend` with a weight per joint: `mask` has `count` numbers, one per joint, from 0 (the first clip) to
// 1 (blended fully), such as `anthronet_clip_joint_mask` makes.
anthronet_status anthronet_clip_blend_masked(const struct anthronet_clip *first,
                                             const struct anthronet_clip *second,
                                             float weight,
                                             const float *mask,
                                             uint32_t count,
                                             struct anthronet_clip **out_clip,
                                             struct anthronet_error *error);

// Adds a clip to another of the same body: the difference between `layer` and the pose `reference` times `weight`, 0 to 1,
// is added to `base`. A layer shorter than the base starts over. `reference` has `count` joints,
// each relative to its parent in `in_space`; NULL and 0 stand for the layer's first frame. `mask` is that of
// `anthronet_clip_blend_masked`; NULL and 0 stand for every joint.
anthronet_status anthronet_clip_additive(const struct anthronet_clip *base,
                                         const struct anthronet_clip *layer,
                                         float weight,
                                         const struct anthronet_transform *reference,
                                         uint32_t count,
                                         uint32_t in_space,
                                         const float *mask,
                                         uint32_t mask_count,
                                         struct anthronet_clip **out_clip,
                                         struct anthronet_error *error);

// The mask of a part of the body: fills `count` entries, one per joint of the clip, with 1 for the joint of that name
// in the rig and all below it, else with 0. `spine_01` is the upper body.
anthronet_status anthronet_clip_joint_mask(const struct anthronet_clip *clip,
                                           const char *name,
                                           uint64_t name_length,
                                           float *out_mask,
                                           uint32_t count,
                                           struct anthronet_error *error);

// Plays two clips of one body one after the other, blended over the `seconds` by which they overlap.
anthronet_status anthronet_clip_crossfade(const struct anthronet_clip *first,
                                          const struct anthronet_clip *second,
                                          double seconds,
                                          struct anthronet_clip **out_clip,
                                          struct anthronet_error *error);

// Reads a motion file: .bvh, .fbx, .glb, .gltf, .vrm, .vrma, .npz (AMASS, SMPL-X), .usd, .usda, .usdc, .usdz.
// `read_options` may be NULL.
anthronet_status anthronet_motion_open_path(const char *path,
                                            uint64_t path_length,
                                            const struct anthronet_motion_options *read_options,
                                            struct anthronet_motion **out_motion,
                                            struct anthronet_error *error);

// Reads a motion file from memory. `name` is the file's: its extension says the format, and a clip without a name gets
// it.
anthronet_status anthronet_motion_open_memory(const uint8_t *data,
                                              uint64_t length,
                                              const char *name,
                                              uint64_t name_length,
                                              const struct anthronet_motion_options *read_options,
                                              struct anthronet_motion **out_motion,
                                              struct anthronet_error *error);

// Makes a motion from poses, to be retargeted like one that was read from a file.
anthronet_status anthronet_motion_from_poses(const struct anthronet_motion_source *source,
                                             struct anthronet_motion **out_motion,
                                             struct anthronet_error *error);

// Frees a motion; NULL is nothing.
void anthronet_motion_free(struct anthronet_motion *motion);

// Number of clips: at least one.
anthronet_status anthronet_motion_clip_count(const struct anthronet_motion *motion,
                                             uint32_t *out_count,
                                             struct anthronet_error *error);

// The name of a clip; valid as long as the motion.
anthronet_status anthronet_motion_clip_name(const struct anthronet_motion *motion,
                                            uint32_t clip,
                                            struct anthronet_text *out_name,
                                            struct anthronet_error *error);

// How the file was read, as JSON: format, unit, up axis, frame rate, how each was found, warnings.
anthronet_status anthronet_motion_report(const struct anthronet_motion *motion,
                                         struct anthronet_bytes **out_json,
                                         struct anthronet_error *error);

// Retargets one clip of a motion to a body. `retarget_options` may be NULL, and so may `out_report`; it receives JSON:
// which joint drives which, which joints drive none, how sure it is that the motion is a person's (`confidence`: `value` from 0
// to 1 and `doubts`, which are also logged as a warning), errors of directions, limits and feet. Below a confidence of
// 0.5 the motion is refused, unless joints are mapped or `force` is set.
anthronet_status anthronet_motion_retarget(const struct anthronet_motion *motion,
                                           uint32_t clip,
                                           const struct anthronet_body *body,
                                           const struct anthronet_retarget_options *retarget_options,
                                           struct anthronet_clip **out_clip,
                                           struct anthronet_bytes **out_report,
                                           struct anthronet_error *error);

// Makes a part of a mesh ready to be posed.
anthronet_status anthronet_skinner_new(const struct anthronet_mesh *mesh,
                                       uint32_t part,
                                       struct anthronet_skinner **out_skinner,
                                       struct anthronet_error *error);

// Frees a skinner; NULL is nothing.
void anthronet_skinner_free(struct anthronet_skinner *skinner);

// Number of vertices that the skinner writes.
anthronet_status anthronet_skinner_vertex_count(const struct anthronet_skinner *skinner,
                                                uint32_t *out_count,
                                                struct anthronet_error *error);

// Poses the surfaces of `count` jobs, on all cores. Nothing is written unless all jobs are in order. From its first byte
// to its last, what a job writes must not overlap what another writes nor what any of them reads. `context` may be NULL.
anthronet_status anthronet_skin(struct anthronet_context *context,
                                const struct anthronet_skin_job *jobs,
                                uint32_t count,
                                struct anthronet_error *error);

// Writes a body to a file in the format of its extension: .glb, .gltf (and .bin beside it), .vrm, .usda, .usdc, .usdz
// or .obj. The file is written completely or not at all. `options` may be NULL.
anthronet_status anthronet_export_path(const struct anthronet_body *body,
                                       const struct anthronet_export_options *options,
                                       const char *path,
                                       uint64_t path_length,
                                       struct anthronet_error *error);

// Writes a body to memory in a format: `glb`, `vrm`, `usda`, `usdc`, `usdz` or `obj`.
anthronet_status anthronet_export_memory(const struct anthronet_body *body,
                                         const struct anthronet_export_options *options,
                                         const char *format,
                                         uint64_t format_length,
                                         struct anthronet_bytes **out_bytes,
                                         struct anthronet_error *error);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* ANTHRONET_H */
