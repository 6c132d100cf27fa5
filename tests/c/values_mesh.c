/* Meshes and joints: sizes, and that every space holds the same person. */

#include "values.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const uint32_t SPACES[] = {ANTHRONET_SPACE_GLTF, ANTHRONET_SPACE_BLENDER, ANTHRONET_SPACE_UNITY};

/* An array of a mesh, looked at for its size and type. */
static const void *array(const anthronet_mesh *mesh, uint32_t part, uint32_t attribute, uint64_t rows,
                         uint32_t columns, uint32_t type) {
    anthronet_view view;
    ZERO(view);
    OK(anthronet_mesh_data(mesh, part, attribute, &view, &fault));
    CHECK(view.rows == rows && view.columns == columns && view.number_type == type,
          "attribute %u: %lu rows of %u numbers of type %u, not %lu of %u of %u", attribute,
          (unsigned long)view.rows, view.columns, view.number_type, (unsigned long)rows, columns, type);
    CHECK((view.data == NULL) == (rows == 0), "attribute %u of %lu rows at %p", attribute, (unsigned long)rows,
          view.data);
    return view.data;
}

static int all_finite(const float *numbers, uint64_t count) {
    uint64_t i;
    for (i = 0; i < count; i++) {
        if (!isfinite(numbers[i])) return 0;
    }
    return 1;
}

static int all_below(const uint32_t *numbers, uint64_t count, uint32_t bound) {
    uint64_t i;
    for (i = 0; i < count; i++) {
        if (numbers[i] >= bound) return 0;
    }
    return 1;
}

/* Six times the volume of the tetrahedron of the origin and a face. */
static double volume6(const float *p, uint32_t a, uint32_t b, uint32_t c) {
    const float *x = p + 3 * (size_t)a, *y = p + 3 * (size_t)b, *z = p + 3 * (size_t)c;
    return (double)x[0] * ((double)y[1] * z[2] - (double)y[2] * z[1]) +
           (double)x[1] * ((double)y[2] * z[0] - (double)y[0] * z[2]) +
           (double)x[2] * ((double)y[0] * z[1] - (double)y[1] * z[0]);
}

/* Arrays of a part: sizes, finite numbers, unit normals, weights; the volume that its faces enclose. */
static double look_at(const fixture *f, const anthronet_mesh *mesh, uint32_t index, int model_layout) {
    anthronet_mesh_part part;
    const float *positions, *normals, *uvs, *weights;
    const uint32_t *triangles, *quads, *sources;
    const uint16_t *joints;
    double volume = 0, along = 0;
    uint32_t v, i;
    SIZED(part);
    OK(anthronet_mesh_describe_part(mesh, index, &part, &fault));
    CHECK(part.vertex_count > 0 && part.name.length > 0, "part %u is empty", index);
    CHECK(part.roughness >= 0 && part.roughness <= 1 && all_finite(part.base_color, 4), "material of %u", index);
    CHECK((index == 0) == is_text(part.name, "Body"), "part %u has the name of another", index);
    positions = (const float *)array(mesh, index, ANTHRONET_ATTRIBUTE_POSITIONS, part.vertex_count, 3, ANTHRONET_TYPE_F32);
    normals = (const float *)array(mesh, index, ANTHRONET_ATTRIBUTE_NORMALS, part.vertex_count, 3, ANTHRONET_TYPE_F32);
    uvs = (const float *)array(mesh, index, ANTHRONET_ATTRIBUTE_UVS, part.uv_count, 2, ANTHRONET_TYPE_F32);
    triangles = (const uint32_t *)array(mesh, index, ANTHRONET_ATTRIBUTE_TRIANGLES, part.triangle_count, 3, ANTHRONET_TYPE_U32);
    quads = (const uint32_t *)array(mesh, index, ANTHRONET_ATTRIBUTE_QUADS, part.quad_count, 4, ANTHRONET_TYPE_U32);
    sources = (const uint32_t *)array(mesh, index, ANTHRONET_ATTRIBUTE_SOURCES, part.vertex_count, 1, ANTHRONET_TYPE_U32);
    joints = (const uint16_t *)array(mesh, index, ANTHRONET_ATTRIBUTE_JOINTS, part.vertex_count, part.influences, ANTHRONET_TYPE_U16);
    weights = (const float *)array(mesh, index, ANTHRONET_ATTRIBUTE_WEIGHTS, part.vertex_count, part.influences, ANTHRONET_TYPE_F32);
    if (!model_layout) {
        CHECK(part.quad_count == 0 && part.uv_count == part.vertex_count, "render layout of part %u", index);
    } else {
        const void *corners = array(mesh, index, ANTHRONET_ATTRIBUTE_QUAD_UVS, part.quad_count, 4, ANTHRONET_TYPE_U32);
        CHECK(all_below((const uint32_t *)corners, 4 * (uint64_t)part.quad_count, part.uv_count), "uvs of quads");
        corners = array(mesh, index, ANTHRONET_ATTRIBUTE_TRIANGLE_UVS, part.triangle_count, 3, ANTHRONET_TYPE_U32);
        CHECK(all_below((const uint32_t *)corners, 3 * (uint64_t)part.triangle_count, part.uv_count), "of triangles");
    }
    if (!CHECK(all_finite(positions, 3 * (uint64_t)part.vertex_count) && all_finite(uvs, 2 * (uint64_t)part.uv_count),
               "part %u has numbers that are not finite", index)) return NAN;
    if (!CHECK(all_below(triangles, 3 * (uint64_t)part.triangle_count, part.vertex_count) &&
                   all_below(quads, 4 * (uint64_t)part.quad_count, part.vertex_count),
               "part %u has faces of vertices that it has not", index)) return NAN;
    for (v = 0; v < 2 * part.uv_count; v++) {
        if (!CHECK(uvs[v] >= 0 && uvs[v] <= 1, "texture coordinate %f", (double)uvs[v])) break;
    }
    for (v = 0; v < part.vertex_count; v++) {
        const float *n = normals + 3 * (size_t)v, *w = weights + (size_t)v * part.influences;
        double sum = 0;
        if (!CHECK(fabs(sqrt((double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2]) - 1) < 1e-4,
                   "normal %u", v)) break;
        for (i = 0; i < part.influences; i++) {
            sum += w[i];
            if (!CHECK(w[i] >= 0 && (i == 0 || w[i] <= w[i - 1]) && joints[v * part.influences + i] < f->joints,
                       "influence %u of vertex %u", i, v)) return NAN;
        }
        if (!CHECK(fabs(sum - 1) < 1e-5, "weights of vertex %u have the sum %f", v, sum)) break;
        if (model_layout && !CHECK(sources[v] == v, "vertex %u of the model is %u", v, sources[v])) break;
    }
    for (i = 0; i < part.triangle_count; i++) {
        const uint32_t *t = triangles + 3 * (size_t)i;
        volume += volume6(positions, t[0], t[1], t[2]) / 6;
    }
    for (i = 0; i < part.quad_count; i++) {
        const uint32_t *q = quads + 4 * (size_t)i;
        volume += (volume6(positions, q[0], q[1], q[2]) + volume6(positions, q[0], q[2], q[3])) / 6;
    }
    /* Normals point out of what faces enclose: the divergence theorem, roughly. */
    for (v = 0; v < part.vertex_count; v++) {
        for (i = 0; i < 3; i++) along += (double)normals[3 * v + i] * positions[3 * v + i];
    }
    if (index == 0) CHECK(along > 0, "normals point inward");
    return volume;
}

void test_meshes(const fixture *f) {
    static const uint32_t QUADS[] = {53520, 13380};
    anthronet_body_summary summary;
    anthronet_mesh_options options;
    size_t s;
    uint32_t lod, layout;
    SIZED(summary);
    OK(anthronet_body_summarise(f->body, &summary, &fault));
    for (lod = f->few ? 3 : 0; lod < 4; lod++) {
        for (layout = 0; layout < 2; layout++) {
            for (s = 0; s < LENGTH(SPACES); s++) {
                anthronet_mesh *mesh = NULL;
                anthronet_mesh_part part;
                uint32_t parts = 0, i, vertices = 0;
                SIZED(options);
                options.lod = lod;
                options.layout = layout;
                options.space = SPACES[s];
                options.influences = layout ? 8 : 0;
                if (!OK(anthronet_mesh_new(f->body, &options, &mesh, &fault))) return;
                OK(anthronet_mesh_part_count(mesh, &parts, &fault));
                CHECK(parts == (lod < 2 ? 7u : 4u), "%u parts at level %u", parts, lod);
                SIZED(part);
                OK(anthronet_mesh_describe_part(mesh, 0, &part, &fault));
                CHECK(part.influences == (layout ? 8u : 4u), "%u influences", part.influences);
                OK(anthronet_model_vertex_count(f->model, lod, &vertices, &fault));
                if (layout) CHECK(part.vertex_count == vertices, "%u vertices", part.vertex_count);
                else CHECK(part.vertex_count > vertices, "no vertex at a seam is doubled");
                if (layout && lod < 2) CHECK(part.quad_count + 200 > QUADS[lod], "%u quads", part.quad_count);
                for (i = 0; i < parts; i++) {
                    double volume = look_at(f, mesh, i, (int)layout);
                    if (i > 0) continue;
                    /* Positive in every space, as cross products of a space are of its own handedness. Lower levels
                     * lie inside. */
                    CHECK(volume > 0.9 * summary.volume_m3 && volume < 1.02 * summary.volume_m3,
                          "level %u, layout %u, space %u: the faces enclose %f m3, the body has %f", lod, layout,
                          SPACES[s], volume, summary.volume_m3);
                }
                anthronet_mesh_free(mesh);
            }
        }
    }
}

void test_mesh_options(const fixture *f) {
    anthronet_mesh_options options;
    anthronet_mesh *mesh = NULL;
    anthronet_mesh_part part, dark;
    uint32_t parts = 0;
    SIZED(options);
    options.lod = 3;
    options.body_only = 1;
    options.skin_tone = 1;
    OK(anthronet_mesh_new(f->body, &options, &mesh, &fault));
    OK(anthronet_mesh_part_count(mesh, &parts, &fault));
    CHECK(parts == 1, "the body alone has %u parts", parts);
    SIZED(part);
    OK(anthronet_mesh_describe_part(mesh, 0, &part, &fault));
    anthronet_mesh_free(mesh);
    options.skin_tone = 10;
    OK(anthronet_mesh_new(f->body, &options, &mesh, &fault));
    SIZED(dark);
    OK(anthronet_mesh_describe_part(mesh, 0, &dark, &fault));
    CHECK(dark.base_color[1] < 0.5f * part.base_color[1], "skin tone 10 is as light as 1");
    anthronet_mesh_free(mesh);
    /* NULL asks for the defaults: level 0. */
    OK(anthronet_mesh_new(f->body, NULL, &mesh, &fault));
    OK(anthronet_mesh_describe_part(mesh, 0, &part, &fault));
    CHECK(part.vertex_count > 53514 && part.influences == 4, "defaults: %u vertices", part.vertex_count);
    anthronet_mesh_free(mesh);
}

/* Rows with room between them, which stays as it is. */
void test_mesh_read(const fixture *f) {
    anthronet_view view;
    uint64_t stride = 20, bytes, row;
    unsigned char *buffer;
    OK(anthronet_mesh_data(f->mesh, 0, ANTHRONET_ATTRIBUTE_POSITIONS, &view, &fault));
    bytes = (view.rows - 1) * stride + 12;
    buffer = (unsigned char *)room(bytes + 8);
    fill(buffer, bytes + 8);
    OK(anthronet_mesh_read(f->mesh, 0, ANTHRONET_ATTRIBUTE_POSITIONS, buffer, bytes, stride, &fault));
    for (row = 0; row < view.rows; row++) {
        if (!CHECK(memcmp(buffer + row * stride, (const char *)view.data + 12 * row, 12) == 0 &&
                       is_filled(buffer + row * stride + 12, 8),
                   "row %lu", (unsigned long)row)) break;
    }
    OK(anthronet_mesh_read(f->mesh, 0, ANTHRONET_ATTRIBUTE_POSITIONS, buffer, bytes, 0, &fault));
    CHECK(memcmp(buffer, view.data, 12 * view.rows) == 0, "packed rows");
    free(buffer);
}

void test_mesh_update(const fixture *f) {
    anthronet_request *request = person(ANTHRONET_SEX_MALE, 1.9);
    anthronet_body *man = NULL;
    anthronet_mesh *updated = NULL, *made = NULL;
    anthronet_mesh_options options;
    anthronet_view a, b;
    SIZED(options);
    options.lod = 2;
    options.space = ANTHRONET_SPACE_UNITY;
    OK(anthronet_generate(f->model, request, &man, &fault));
    OK(anthronet_mesh_new(f->body, &options, &updated, &fault));
    OK(anthronet_mesh_update(updated, man, &fault));
    OK(anthronet_mesh_new(man, &options, &made, &fault));
    OK(anthronet_mesh_data(updated, 0, ANTHRONET_ATTRIBUTE_POSITIONS, &a, &fault));
    OK(anthronet_mesh_data(made, 0, ANTHRONET_ATTRIBUTE_POSITIONS, &b, &fault));
    CHECK(a.rows == b.rows && memcmp(a.data, b.data, 12 * a.rows) == 0, "updated and made differ");
    anthronet_mesh_free(updated);
    anthronet_mesh_free(made);
    anthronet_body_free(man);
    anthronet_request_free(request);
}

/* A mesh and its way to a man's is that man's mesh; updated, it has no ways left. */
void test_blend_shapes(const fixture *f) {
    anthronet_request *request = person(ANTHRONET_SEX_MALE, 1.72);
    anthronet_body *man = NULL;
    anthronet_mesh *mesh = NULL, *his = NULL;
    anthronet_mesh_options options;
    anthronet_view from, way, to;
    anthronet_text name;
    uint32_t count = 0, part, attribute;
    uint64_t i;
    double off = 0, far = 0;
    float *copied;
    SIZED(options);
    options.lod = 1;
    options.space = ANTHRONET_SPACE_BLENDER;
    OK(anthronet_generate(f->model, request, &man, &fault));
    OK(anthronet_mesh_new(f->body, &options, &mesh, &fault));
    OK(anthronet_mesh_new(man, &options, &his, &fault));
    OK(anthronet_mesh_add_blend_shape(mesh, TEXT("him"), man, &fault));
    OK(anthronet_mesh_add_blend_shape(mesh, TEXT("herself"), f->body, &fault));
    OK(anthronet_mesh_blend_shape_count(mesh, &count, &fault));
    CHECK(count == 2, "%u blend shapes", count);
    OK(anthronet_mesh_blend_shape_name(mesh, 0, &name, &fault));
    CHECK(is_text(name, "him"), "the first has another name");
    OK(anthronet_mesh_part_count(mesh, &count, &fault));
    for (part = 0; part < count; part++) {
        for (attribute = ANTHRONET_ATTRIBUTE_POSITIONS; attribute <= ANTHRONET_ATTRIBUTE_NORMALS; attribute++) {
            OK(anthronet_mesh_data(mesh, part, attribute, &from, &fault));
            OK(anthronet_mesh_data(his, part, attribute, &to, &fault));
            OK(anthronet_mesh_blend_shape_data(mesh, 0, part, attribute, &way, &fault));
            if (!CHECK(way.rows == from.rows && to.rows == from.rows && way.columns == 3, "part %u", part)) continue;
            copied = (float *)room(12 * (size_t)way.rows);
            OK(anthronet_mesh_read_blend_shape(mesh, 0, part, attribute, copied, 12 * way.rows, 0, &fault));
            for (i = 0; i < 3 * from.rows; i++) {
                double at = (double)((const float *)from.data)[i] + copied[i];
                off = fmax(off, fabs(at - ((const float *)to.data)[i]));
                if (attribute == ANTHRONET_ATTRIBUTE_POSITIONS) far = fmax(far, fabs((double)copied[i]));
            }
            CHECK(memcmp(copied, way.data, 12 * (size_t)way.rows) == 0, "copied and looked at differ");
            free(copied);
        }
    }
    CHECK(off < 1e-5, "at weight 1 the mesh is off by %g", off);
    CHECK(far > 0.01, "the way is at most %g m", far);
    REFUSED(ANTHRONET_ERROR_INVALID, anthronet_mesh_add_blend_shape(mesh, TEXT("him"), man, &fault));
    REFUSED(ANTHRONET_ERROR_INVALID, anthronet_mesh_add_blend_shape(mesh, NULL, 0, man, &fault));
    OK(anthronet_mesh_update(mesh, man, &fault));
    OK(anthronet_mesh_blend_shape_count(mesh, &count, &fault));
    CHECK(count == 0, "%u blend shapes after an update", count);
    anthronet_mesh_free(mesh);
    anthronet_mesh_free(his);
    anthronet_body_free(man);
    anthronet_request_free(request);
}

/* The largest difference of a product of two column-major matrices from the identity. */
static double off_identity(const float *a, const float *b) {
    double worst = 0;
    int row, column, k;
    for (row = 0; row < 4; row++) {
        for (column = 0; column < 4; column++) {
            double sum = 0;
            for (k = 0; k < 4; k++) sum += (double)a[4 * k + row] * b[4 * column + k];
            worst = fmax(worst, fabs(sum - (row == column)));
        }
    }
    return worst;
}

static uint32_t joint_called(const fixture *f, uint32_t names, const char *name) {
    anthronet_text text;
    uint32_t j;
    for (j = 0; j < f->joints; j++) {
        if (OK(anthronet_body_joint_name(f->body, j, names, &text, &fault)) && is_text(text, name)) return j;
    }
    CHECK(0, "no joint is called %s", name);
    return 0;
}

void test_joints(const fixture *f) {
    static const char *const LEFT_HAND[] = {"hand_l", "LeftHand", "mixamorig:LeftHand", "leftHand", "hand.L"};
    anthronet_joint *joints = (anthronet_joint *)room(f->joints * sizeof *joints);
    size_t s;
    uint32_t j, names;
    int k;
    for (s = 0; s < LENGTH(SPACES); s++) {
        anthronet_transform *pose = rest_pose(f, f->body, SPACES[s]);
        uint32_t hand = joint_called(f, ANTHRONET_NAMES_NATIVE, LEFT_HAND[0]);
        uint32_t head = joint_called(f, ANTHRONET_NAMES_NATIVE, "head");
        const float *at;
        OK(anthronet_body_joints(f->body, SPACES[s], joints, f->joints, &fault));
        for (j = 0; j < f->joints; j++) {
            const float *m = joints[j].model_from_joint, *r = pose[j].rotation;
            double determinant = (double)m[0] * ((double)m[5] * m[10] - (double)m[6] * m[9]) -
                                 (double)m[4] * ((double)m[1] * m[10] - (double)m[2] * m[9]) +
                                 (double)m[8] * ((double)m[1] * m[6] - (double)m[2] * m[5]);
            CHECK(joints[j].parent < (int32_t)j && (j == 0) == (joints[j].parent == -1), "parent of %u", j);
            CHECK(joints[j].length > 0 && joints[j].length < 1, "joint %u is %f m long", j, (double)joints[j].length);
            CHECK(off_identity(m, joints[j].joint_from_model) < 1e-5, "inverse bind of %u", j);
            CHECK(fabs(determinant - 1) < 1e-5, "joint %u has a determinant of %f", j, determinant);
            for (k = 0; k < 3; k++) {
                CHECK(fabsf(m[12 + k] - pose[j].translation[k]) < 1e-5f, "joint %u is not where its parents say", j);
            }
            /* The second column: where the joint's +Y axis points. */
            CHECK(fabsf(m[4] - 2 * (r[0] * r[1] - r[3] * r[2])) < 1e-5f &&
                      fabsf(m[5] - (1 - 2 * (r[0] * r[0] + r[2] * r[2]))) < 1e-5f &&
                      fabsf(m[6] - 2 * (r[1] * r[2] + r[3] * r[0])) < 1e-5f,
                  "joint %u is turned otherwise than its parents say", j);
        }
        at = joints[hand].model_from_joint + 12;
        CHECK(SPACES[s] == ANTHRONET_SPACE_UNITY ? at[0] < -0.4f : at[0] > 0.4f, "space %u: left hand at x = %f",
              SPACES[s], (double)at[0]);
        at = joints[head].model_from_joint + 12;
        CHECK(at[SPACES[s] == ANTHRONET_SPACE_BLENDER ? 2 : 1] > 1.3f, "space %u: the head is not above", SPACES[s]);
        free(pose);
    }
    for (names = 0; names < LENGTH(LEFT_HAND); names++) {
        CHECK(joint_called(f, names, LEFT_HAND[names]) == joint_called(f, 0, LEFT_HAND[0]), "names %u", names);
    }
    free(joints);
}

void test_humanoid(const fixture *f) {
    anthronet_humanoid_bone bone;
    uint32_t i, required = 0;
    CHECK(anthronet_humanoid_bone_count() == 55, "%u bones", anthronet_humanoid_bone_count());
    for (i = 0; i < anthronet_humanoid_bone_count(); i++) {
        char name[64];
        SIZED(bone);
        OK(anthronet_humanoid_bone_at(i, &bone, &fault));
        required += bone.required;
        CHECK(bone.unity.length > 0 && bone.unity_trait.length > 0 && bone.mixamo.length > 0 && bone.vrm.length > 0 &&
                  bone.blender.length > 0,
              "bone %u lacks a name", i);
        if (!CHECK(bone.native.length < sizeof name, "a long name")) continue;
        memcpy(name, bone.native.data, bone.native.length);
        name[bone.native.length] = 0;
        joint_called(f, ANTHRONET_NAMES_NATIVE, name);
    }
    CHECK(required == 15, "%u bones are required", required);
}
