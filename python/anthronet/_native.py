"""Declarations of libanthronet: what `include/anthronet.h` says, in the words of ctypes.

Made from ffi/src by `cargo xtask gen`; do not edit.
"""

from ctypes import (
    CFUNCTYPE,
    POINTER,
    Structure,
    c_char,
    c_char_p,
    c_double,
    c_float,
    c_int32,
    c_uint32,
    c_uint64,
    c_void_p,
)

ABI_VERSION = 1
OK = 0
ERROR_POINTER = 101
ERROR_SIZE = 102
ERROR_ENUM = 103
ERROR_INDEX = 104
ERROR_TEXT = 105
ERROR_REQUEST = 201
ERROR_INFEASIBLE = 202
ERROR_MODEL = 301
ERROR_FILE = 401
ERROR_IO = 402
ERROR_INVALID = 501
ERROR_BUSY = 601
ERROR_CANCELLED = 602
ERROR_TAKEN = 603
ERROR_OTHER = 900
ERROR_PANIC = 901
SPACE_GLTF = 0
SPACE_BLENDER = 1
SPACE_UNITY = 2
NAMES_NATIVE = 0
NAMES_UNITY = 1
NAMES_MIXAMO = 2
NAMES_VRM = 3
NAMES_BLENDER = 4
SKIN_LINEAR = 0
SKIN_DUAL_QUATERNION = 1
SKIN_JOINT_TRANSLATION = 2
LOG_INFO = 0
LOG_WARNING = 1
LOG_ERROR = 2
SEX_ANY = 0
SEX_FEMALE = 1
SEX_MALE = 2
FILL_MEAN = 0
FILL_SAMPLE = 1
JOB_RUNNING = 0
JOB_DONE = 1
JOB_CANCELLED = 2
LAYOUT_RENDER = 0
LAYOUT_MODEL = 1
ATTRIBUTE_POSITIONS = 0
ATTRIBUTE_NORMALS = 1
ATTRIBUTE_UVS = 2
ATTRIBUTE_TRIANGLES = 3
ATTRIBUTE_JOINTS = 4
ATTRIBUTE_WEIGHTS = 5
ATTRIBUTE_SOURCES = 6
ATTRIBUTE_QUADS = 7
ATTRIBUTE_QUAD_UVS = 8
ATTRIBUTE_TRIANGLE_UVS = 9
TYPE_F32 = 0
TYPE_U32 = 1
TYPE_U16 = 2
WRAP_ONCE = 0
WRAP_LOOP = 1
WRAP_ROOT_MOTION = 2
RELATIVE_TO_PARENT = 0
RELATIVE_TO_MODEL = 1
FINGERS_SOURCE = 0
FINGERS_RELAXED = 1
FINGERS_REST = 2
UP_FOUND = 0
UP_Y = 1
UP_Z = 2
UP_X = 3
UP_NEGATIVE_X = 4
UP_NEGATIVE_Y = 5
UP_NEGATIVE_Z = 6

LogCallback = CFUNCTYPE(None, c_uint32, c_void_p, c_uint64, c_void_p)


class Text(Structure):
    _fields_ = [
        ("data", c_void_p),
        ("length", c_uint64),
    ]


class Error(Structure):
    _fields_ = [
        ("code", c_int32),
        ("message", c_char * 512),
    ]


class Measured(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("lod", c_uint32),
        ("mass_kg", c_double),
        ("volume_m3", c_double),
        ("bmi", c_double),
    ]


class MeasureReport(Structure):
    _fields_ = [
        ("asked", c_double),
        ("obtained", c_double),
        ("residual", c_double),
        ("low90", c_double),
        ("high90", c_double),
        ("percentile", c_double),
        ("given", c_uint32),
        ("filled", c_uint32),
    ]


class BodySummary(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("sex", c_uint32),
        ("seed", c_uint64),
        ("mass_kg", c_double),
        ("volume_m3", c_double),
        ("bmi", c_double),
        ("solve_residual", c_double),
        ("iterations", c_uint32),
        ("converged", c_uint32),
        ("joint_count", c_uint32),
        ("warning_count", c_uint32),
    ]


class JobProgress(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("state", c_uint32),
        ("done", c_uint32),
        ("total", c_uint32),
    ]


class Transform(Structure):
    _fields_ = [
        ("rotation", c_float * 4),
        ("translation", c_float * 3),
    ]


class Joint(Structure):
    _fields_ = [
        ("parent", c_int32),
        ("length", c_float),
        ("parent_from_joint", Transform),
        ("model_from_joint", c_float * 16),
        ("joint_from_model", c_float * 16),
    ]


class HumanoidBone(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("required", c_uint32),
        ("native", Text),
        ("unity", Text),
        ("unity_trait", Text),
        ("mixamo", Text),
        ("vrm", Text),
        ("blender", Text),
    ]


class MeshOptions(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("lod", c_uint32),
        ("influences", c_uint32),
        ("space", c_uint32),
        ("layout", c_uint32),
        ("body_only", c_uint32),
        ("skin_tone", c_uint32),
    ]


class MeshPart(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("vertex_count", c_uint32),
        ("uv_count", c_uint32),
        ("triangle_count", c_uint32),
        ("quad_count", c_uint32),
        ("influences", c_uint32),
        ("double_sided", c_uint32),
        ("roughness", c_float),
        ("base_color", c_float * 4),
        ("name", Text),
    ]


class View(Structure):
    _fields_ = [
        ("data", c_void_p),
        ("rows", c_uint64),
        ("columns", c_uint32),
        ("number_type", c_uint32),
    ]


class ClipInfo(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("frame_count", c_uint32),
        ("joint_count", c_uint32),
        ("reserved", c_uint32),
        ("frames_per_second", c_double),
        ("duration", c_double),
        ("name", Text),
    ]


class MotionOptions(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("up", c_uint32),
        ("metres_per_unit", c_double),
        ("frames_per_second", c_double),
        ("person", c_uint32),
    ]


class MotionSource(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("space", c_uint32),
        ("joint_count", c_uint32),
        ("frame_count", c_uint32),
        ("frames_per_second", c_double),
        ("name", Text),
        ("joint_names", c_void_p),
        ("parents", c_void_p),
        ("rest", c_void_p),
        ("frames", c_void_p),
    ]


class RetargetOptions(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("fingers", c_uint32),
        ("no_limits", c_uint32),
        ("no_feet", c_uint32),
        ("in_place", c_uint32),
        ("looped", c_uint32),
        ("root_motion", c_uint32),
        ("mapping_length", c_uint32),
        ("mapping_json", c_void_p),
        ("frames_per_second", c_double),
        ("force", c_uint32),
    ]


class SkinJob(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("method", c_uint32),
        ("skinner", c_void_p),
        ("joints", c_void_p),
        ("joint_count", c_uint32),
        ("offset_count", c_uint32),
        ("offsets", c_void_p),
        ("positions", c_void_p),
        ("position_bytes", c_uint64),
        ("position_stride", c_uint64),
        ("normals", c_void_p),
        ("normal_bytes", c_uint64),
        ("normal_stride", c_uint64),
    ]


class ExportOptions(Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("lod", c_uint32),
        ("influences", c_uint32),
        ("joint_names", c_uint32),
        ("body_only", c_uint32),
        ("skin_tone", c_uint32),
        ("compress", c_uint32),
        ("clip_count", c_uint32),
        ("clips", c_void_p),
        ("pose", c_void_p),
        ("pose_length", c_uint64),
    ]


# Name: what it returns, and what it takes.
FUNCTIONS = {
    "anthronet_abi_version": (c_uint32, []),
    "anthronet_version": (c_int32, [POINTER(Text), POINTER(Error)]),
    "anthronet_set_log_callback": (c_int32, [LogCallback, c_void_p, POINTER(Error)]),
    "anthronet_bytes_data": (c_int32, [c_void_p, c_void_p, c_void_p, POINTER(Error)]),
    "anthronet_bytes_free": (None, [c_void_p]),
    "anthronet_model_open_embedded": (c_int32, [c_void_p, POINTER(Error)]),
    "anthronet_model_open_default": (c_int32, [c_void_p, POINTER(Error)]),
    "anthronet_model_open_path": (c_int32, [c_char_p, c_uint64, c_void_p, POINTER(Error)]),
    "anthronet_model_open_memory": (c_int32, [c_void_p, c_uint64, c_void_p, POINTER(Error)]),
    "anthronet_model_free": (None, [c_void_p]),
    "anthronet_model_info": (c_int32, [c_void_p, c_void_p, POINTER(Error)]),
    "anthronet_model_latent_size": (c_int32, [c_void_p, c_void_p, POINTER(Error)]),
    "anthronet_model_vertex_count": (c_int32, [c_void_p, c_uint32, c_void_p, POINTER(Error)]),
    "anthronet_model_measure_range": (c_int32, [c_void_p, c_uint32, c_void_p, c_void_p, POINTER(Error)]),
    "anthronet_measure_count": (c_uint32, []),
    "anthronet_measure_name": (c_int32, [c_uint32, POINTER(Text), POINTER(Error)]),
    "anthronet_measure_index": (c_int32, [c_char_p, c_uint64, c_void_p, POINTER(Error)]),
    "anthronet_measure_mesh": (c_int32, [c_void_p, c_void_p, c_uint32, c_uint64, c_uint32, c_void_p, c_uint32, POINTER(Measured), POINTER(Error)]),
    "anthronet_measure_file": (c_int32, [c_void_p, c_char_p, c_uint64, c_void_p, c_uint32, POINTER(Measured), POINTER(Error)]),
    "anthronet_measure_file_report": (c_int32, [c_void_p, c_char_p, c_uint64, c_void_p, POINTER(Error)]),
    "anthronet_request_new": (c_int32, [c_void_p, POINTER(Error)]),
    "anthronet_request_from_json": (c_int32, [c_char_p, c_uint64, c_void_p, POINTER(Error)]),
    "anthronet_request_copy": (c_int32, [c_void_p, c_void_p, POINTER(Error)]),
    "anthronet_request_free": (None, [c_void_p]),
    "anthronet_request_to_json": (c_int32, [c_void_p, c_void_p, POINTER(Error)]),
    "anthronet_request_set_sex": (c_int32, [c_void_p, c_uint32, POINTER(Error)]),
    "anthronet_request_set_measure": (c_int32, [c_void_p, c_char_p, c_uint64, c_double, POINTER(Error)]),
    "anthronet_request_set_measures": (c_int32, [c_void_p, c_void_p, c_void_p, c_uint32, POINTER(Error)]),
    "anthronet_request_measures": (c_int32, [c_void_p, c_void_p, c_void_p, c_uint32, POINTER(Error)]),
    "anthronet_request_unset_measure": (c_int32, [c_void_p, c_uint32, POINTER(Error)]),
    "anthronet_request_set_seed": (c_int32, [c_void_p, c_uint64, POINTER(Error)]),
    "anthronet_request_set_latent": (c_int32, [c_void_p, c_void_p, c_uint32, POINTER(Error)]),
    "anthronet_request_set_fill": (c_int32, [c_void_p, c_uint32, POINTER(Error)]),
    "anthronet_request_set_nearest": (c_int32, [c_void_p, c_uint32, POINTER(Error)]),
    "anthronet_generate": (c_int32, [c_void_p, c_void_p, c_void_p, POINTER(Error)]),
    "anthronet_interpolate": (c_int32, [c_void_p, c_void_p, c_void_p, c_double, c_void_p, POINTER(Error)]),
    "anthronet_body_free": (None, [c_void_p]),
    "anthronet_body_report": (c_int32, [c_void_p, c_void_p, POINTER(Error)]),
    "anthronet_body_measures": (c_int32, [c_void_p, c_void_p, c_uint32, POINTER(Error)]),
    "anthronet_body_summarise": (c_int32, [c_void_p, POINTER(BodySummary), POINTER(Error)]),
    "anthronet_body_latent": (c_int32, [c_void_p, c_void_p, c_uint32, POINTER(Error)]),
    "anthronet_job_start": (c_int32, [c_void_p, c_void_p, c_uint32, c_void_p, POINTER(Error)]),
    "anthronet_job_poll": (c_int32, [c_void_p, POINTER(JobProgress), POINTER(Error)]),
    "anthronet_job_cancel": (c_int32, [c_void_p, POINTER(Error)]),
    "anthronet_job_take": (c_int32, [c_void_p, c_uint32, c_void_p, POINTER(Error)]),
    "anthronet_job_free": (None, [c_void_p]),
    "anthronet_body_joints": (c_int32, [c_void_p, c_uint32, c_void_p, c_uint32, POINTER(Error)]),
    "anthronet_body_joint_name": (c_int32, [c_void_p, c_uint32, c_uint32, POINTER(Text), POINTER(Error)]),
    "anthronet_humanoid_bone_count": (c_uint32, []),
    "anthronet_humanoid_bone_at": (c_int32, [c_uint32, POINTER(HumanoidBone), POINTER(Error)]),
    "anthronet_mesh_new": (c_int32, [c_void_p, POINTER(MeshOptions), c_void_p, POINTER(Error)]),
    "anthronet_mesh_update": (c_int32, [c_void_p, c_void_p, POINTER(Error)]),
    "anthronet_mesh_free": (None, [c_void_p]),
    "anthronet_mesh_part_count": (c_int32, [c_void_p, c_void_p, POINTER(Error)]),
    "anthronet_mesh_describe_part": (c_int32, [c_void_p, c_uint32, POINTER(MeshPart), POINTER(Error)]),
    "anthronet_mesh_data": (c_int32, [c_void_p, c_uint32, c_uint32, POINTER(View), POINTER(Error)]),
    "anthronet_mesh_read": (c_int32, [c_void_p, c_uint32, c_uint32, c_void_p, c_uint64, c_uint64, POINTER(Error)]),
    "anthronet_mesh_add_blend_shape": (c_int32, [c_void_p, c_char_p, c_uint64, c_void_p, POINTER(Error)]),
    "anthronet_mesh_blend_shape_count": (c_int32, [c_void_p, c_void_p, POINTER(Error)]),
    "anthronet_mesh_blend_shape_name": (c_int32, [c_void_p, c_uint32, POINTER(Text), POINTER(Error)]),
    "anthronet_mesh_blend_shape_data": (c_int32, [c_void_p, c_uint32, c_uint32, c_uint32, POINTER(View), POINTER(Error)]),
    "anthronet_mesh_read_blend_shape": (c_int32, [c_void_p, c_uint32, c_uint32, c_uint32, c_void_p, c_uint64, c_uint64, POINTER(Error)]),
    "anthronet_context_new": (c_int32, [c_void_p, POINTER(Error)]),
    "anthronet_context_free": (None, [c_void_p]),
    "anthronet_clip_builtin_count": (c_uint32, []),
    "anthronet_clip_builtin_name": (c_int32, [c_uint32, POINTER(Text), POINTER(Error)]),
    "anthronet_clip_builtin": (c_int32, [c_char_p, c_uint64, c_void_p, c_void_p, POINTER(Error)]),
    "anthronet_clip_from_poses": (c_int32, [c_void_p, c_char_p, c_uint64, c_double, c_uint32, c_void_p, c_uint64, c_void_p, POINTER(Error)]),
    "anthronet_clip_free": (None, [c_void_p]),
    "anthronet_clip_describe": (c_int32, [c_void_p, POINTER(ClipInfo), POINTER(Error)]),
    "anthronet_clip_sample": (c_int32, [c_void_p, c_void_p, c_double, c_uint32, c_uint32, c_uint32, c_void_p, c_uint32, POINTER(Error)]),
    "anthronet_clip_bake": (c_int32, [c_void_p, c_uint32, c_uint32, c_void_p, c_uint64, POINTER(Error)]),
    "anthronet_clip_resample": (c_int32, [c_void_p, c_double, c_void_p, POINTER(Error)]),
    "anthronet_clip_in_place": (c_int32, [c_void_p, c_void_p, POINTER(Error)]),
    "anthronet_clip_looped": (c_int32, [c_void_p, c_double, c_void_p, POINTER(Error)]),
    "anthronet_clip_blend": (c_int32, [c_void_p, c_void_p, c_float, c_void_p, POINTER(Error)]),
    "anthronet_clip_blend_masked": (c_int32, [c_void_p, c_void_p, c_float, c_void_p, c_uint32, c_void_p, POINTER(Error)]),
    "anthronet_clip_additive": (c_int32, [c_void_p, c_void_p, c_float, c_void_p, c_uint32, c_uint32, c_void_p, c_uint32, c_void_p, POINTER(Error)]),
    "anthronet_clip_joint_mask": (c_int32, [c_void_p, c_char_p, c_uint64, c_void_p, c_uint32, POINTER(Error)]),
    "anthronet_clip_crossfade": (c_int32, [c_void_p, c_void_p, c_double, c_void_p, POINTER(Error)]),
    "anthronet_motion_open_path": (c_int32, [c_char_p, c_uint64, POINTER(MotionOptions), c_void_p, POINTER(Error)]),
    "anthronet_motion_open_memory": (c_int32, [c_void_p, c_uint64, c_char_p, c_uint64, POINTER(MotionOptions), c_void_p, POINTER(Error)]),
    "anthronet_motion_from_poses": (c_int32, [POINTER(MotionSource), c_void_p, POINTER(Error)]),
    "anthronet_motion_free": (None, [c_void_p]),
    "anthronet_motion_clip_count": (c_int32, [c_void_p, c_void_p, POINTER(Error)]),
    "anthronet_motion_clip_name": (c_int32, [c_void_p, c_uint32, POINTER(Text), POINTER(Error)]),
    "anthronet_motion_report": (c_int32, [c_void_p, c_void_p, POINTER(Error)]),
    "anthronet_motion_retarget": (c_int32, [c_void_p, c_uint32, c_void_p, POINTER(RetargetOptions), c_void_p, c_void_p, POINTER(Error)]),
    "anthronet_skinner_new": (c_int32, [c_void_p, c_uint32, c_void_p, POINTER(Error)]),
    "anthronet_skinner_free": (None, [c_void_p]),
    "anthronet_skinner_vertex_count": (c_int32, [c_void_p, c_void_p, POINTER(Error)]),
    "anthronet_skin": (c_int32, [c_void_p, c_void_p, c_uint32, POINTER(Error)]),
    "anthronet_export_path": (c_int32, [c_void_p, POINTER(ExportOptions), c_char_p, c_uint64, POINTER(Error)]),
    "anthronet_export_memory": (c_int32, [c_void_p, POINTER(ExportOptions), c_char_p, c_uint64, c_void_p, POINTER(Error)]),
}
