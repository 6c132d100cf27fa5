/* The library, its model, measures, requests and bodies. */

#include "values.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What is asked for is met within this, metres. */
#define TENTH_OF_A_MILLIMETRE 1e-4

static uint32_t measure(const char *name) {
    uint32_t index = 999;
    OK(anthronet_measure_index(name, strlen(name), &index, &fault));
    return index;
}

void test_version(const fixture *f) {
    anthronet_text version;
    (void)f;
    CHECK(anthronet_abi_version() == ANTHRONET_ABI_VERSION, "abi version %u", anthronet_abi_version());
    OK(anthronet_version(&version, &fault));
    CHECK(version.length >= 5 && memchr(version.data, '.', version.length) != NULL, "no version");
}

void test_model_open(const fixture *f) {
    anthronet_model *from_path = NULL, *from_memory = NULL, *by_default = NULL;
    uint64_t length = 0;
    unsigned char *bytes = read_file(f->model_path, &length);
    anthronet_model *all[3];
    double here[MEASURES], expected[MEASURES];
    anthronet_measure_report report[MEASURES];
    anthronet_body *body = NULL;
    size_t i, m;
    OK(anthronet_model_open_path(f->model_path, strlen(f->model_path), &from_path, &fault));
    OK(anthronet_model_open_memory(bytes, length, &from_memory, &fault));
    memset(bytes, 0, length);
    free(bytes);
    OK(anthronet_model_open_default(&by_default, &fault));
    OK(anthronet_body_measures(f->body, report, MEASURES, &fault));
    for (m = 0; m < MEASURES; m++) expected[m] = report[m].obtained;
    all[0] = from_path;
    all[1] = from_memory;
    all[2] = by_default;
    for (i = 0; i < LENGTH(all); i++) {
        OK(anthronet_generate(all[i], f->request, &body, &fault));
        OK(anthronet_body_measures(body, report, MEASURES, &fault));
        for (m = 0; m < MEASURES; m++) here[m] = report[m].obtained;
        CHECK(memcmp(here, expected, sizeof here) == 0, "model %u makes another body", (unsigned)i);
        anthronet_body_free(body);
        anthronet_model_free(all[i]);
    }
}

void test_model_describes(const fixture *f) {
    anthronet_bytes *json = NULL;
    uint32_t latent = 0, vertices = 0;
    double low = 0, high = 0;
    OK(anthronet_model_info(f->model, &json, &fault));
    CHECK(contains_freed(json, "waist_circumference"), "the model's JSON names no measure");
    OK(anthronet_model_latent_size(f->model, &latent, &fault));
    CHECK(latent > 0 && latent < 1000, "%u latent numbers", latent);
    OK(anthronet_model_vertex_count(f->model, 0, &vertices, &fault));
    CHECK(vertices == 53514, "%u vertices at level 0", vertices);
    OK(anthronet_model_vertex_count(f->model, 1, &vertices, &fault));
    CHECK(vertices == 13380, "%u vertices at level 1", vertices);
    OK(anthronet_model_measure_range(f->model, measure("height"), &low, &high, &fault));
    CHECK(low > 1.0 && low < 1.6 && high > 1.85 && high < 2.6, "height from %f to %f", low, high);
}

void test_measures(const fixture *f) {
    anthronet_text name;
    uint32_t i, index;
    (void)f;
    CHECK(anthronet_measure_count() == MEASURES, "%u measures", anthronet_measure_count());
    for (i = 0; i < MEASURES; i++) {
        OK(anthronet_measure_name(i, &name, &fault));
        OK(anthronet_measure_index(name.data, name.length, &index, &fault));
        CHECK(index == i, "measure %u is found at %u", i, index);
    }
    OK(anthronet_measure_name(0, &name, &fault));
    CHECK(is_text(name, "waist_circumference"), "the first measure has another name");
    CHECK(measure("height") == 3, "height is measure %u", measure("height"));
}

void test_request(const fixture *f) {
    anthronet_request *request = NULL, *copy = NULL, *read = NULL;
    anthronet_bytes *json = NULL;
    double metres[MEASURES], again[MEASURES], *latent;
    uint8_t given[MEASURES], given_again[MEASURES];
    const uint8_t *text = NULL;
    uint64_t length = 0;
    uint32_t i, size = 0;
    OK(anthronet_request_from_json(TEXT("{\"sex\": \"male\", \"measures\": {\"height\": 1.8}, \"seed\": 7}"),
                                   &request, &fault));
    OK(anthronet_request_measures(request, metres, given, MEASURES, &fault));
    for (i = 0; i < MEASURES; i++) {
        int is_height = i == measure("height");
        CHECK(given[i] == is_height && metres[i] == (is_height ? 1.8 : 0.0), "measure %u", i);
    }
    /* A name without its side gives both. */
    OK(anthronet_request_set_measure(request, TEXT("arm_length"), 0.33, &fault));
    OK(anthronet_request_measures(request, metres, given, MEASURES, &fault));
    CHECK(metres[measure("arm_length_left")] == 0.33 && metres[measure("arm_length_right")] == 0.33, "arms");
    OK(anthronet_request_unset_measure(request, measure("arm_length_left"), &fault));
    OK(anthronet_request_measures(request, metres, given, MEASURES, &fault));
    CHECK(!given[measure("arm_length_left")] && given[measure("arm_length_right")], "an arm is opened");
    /* All at once, an open one being anything. */
    metres[0] = NAN;
    given[0] = 0;
    OK(anthronet_request_set_measures(request, metres, given, MEASURES, &fault));
    OK(anthronet_request_measures(request, again, given_again, MEASURES, &fault));
    CHECK(memcmp(given, given_again, sizeof given) == 0 && again[0] == 0.0, "measures set all at once");
    OK(anthronet_request_set_sex(request, ANTHRONET_SEX_FEMALE, &fault));
    OK(anthronet_request_set_seed(request, 123456789, &fault));
    OK(anthronet_request_set_fill(request, ANTHRONET_FILL_SAMPLE, &fault));
    OK(anthronet_request_set_nearest(request, 1, &fault));
    OK(anthronet_model_latent_size(f->model, &size, &fault));
    latent = (double *)room(size * sizeof *latent);
    for (i = 0; i < size; i++) latent[i] = i % 2 ? 0.25 : -0.5;
    OK(anthronet_request_set_latent(request, latent, size, &fault));
    free(latent);
    /* The copy asks for the same, and so does what is read from its JSON. */
    OK(anthronet_request_copy(request, &copy, &fault));
    OK(anthronet_request_set_sex(request, ANTHRONET_SEX_MALE, &fault));
    anthronet_request_free(request);
    OK(anthronet_request_to_json(copy, &json, &fault));
    OK(anthronet_bytes_data(json, &text, &length, &fault));
    OK(anthronet_request_from_json((const char *)text, length, &read, &fault));
    anthronet_bytes_free(json);
    OK(anthronet_request_to_json(read, &json, &fault));
    CHECK(contains_freed(json, "female"), "the copy lost its sex");
    OK(anthronet_request_to_json(read, &json, &fault));
    CHECK(contains_freed(json, "123456789"), "the copy lost its seed");
    anthronet_request_free(copy);
    anthronet_request_free(read);
}

/* Height and waist as the tape finds them, on the body and on its mesh. */
void test_generate(const fixture *f) {
    static const struct {
        uint32_t sex;
        double height, waist;
        uint64_t seed;
    } asked[] = {{ANTHRONET_SEX_FEMALE, 1.62, 0.71, 0}, {ANTHRONET_SEX_MALE, 1.85, 0.92, 3},
                 {ANTHRONET_SEX_MALE, 1.70, 1.10, 11}, {ANTHRONET_SEX_FEMALE, 1.75, 0.85, 99}};
    anthronet_measure_report report[MEASURES];
    anthronet_body_summary summary;
    anthronet_mesh_options options;
    anthronet_measured measured;
    anthronet_bytes *json = NULL;
    double metres[MEASURES];
    size_t i, v;
    int m;
    for (i = 0; i < (f->few ? 1 : LENGTH(asked)); i++) {
        anthronet_request *request = person(asked[i].sex, asked[i].height);
        anthronet_body *body = NULL;
        anthronet_mesh *mesh = NULL;
        anthronet_view view;
        const float *p;
        float low = INFINITY, high = -INFINITY;
        OK(anthronet_request_set_measure(request, TEXT("waist_circumference"), asked[i].waist, &fault));
        OK(anthronet_request_set_seed(request, asked[i].seed, &fault));
        if (!OK(anthronet_generate(f->model, request, &body, &fault))) return;
        OK(anthronet_body_measures(body, report, MEASURES, &fault));
        CHECK(report[3].given && report[3].asked == asked[i].height, "the height that was asked is lost");
        CHECK(!report[1].given && report[1].asked == 0 && report[1].residual == 0, "an open measure was asked");
        for (m = 0; m < MEASURES; m++) {
            if (report[m].given) {
                CHECK(fabs(report[m].obtained - report[m].asked) < TENTH_OF_A_MILLIMETRE &&
                          fabs(report[m].residual - (report[m].obtained - report[m].asked)) < 1e-12,
                      "measure %d: asked %f, obtained %f", m, report[m].asked, report[m].obtained);
            }
            CHECK(report[m].low90 <= report[m].high90 && report[m].percentile >= 0 && report[m].percentile <= 100,
                  "measure %d: 90 %% from %f to %f, percentile %f", m, report[m].low90, report[m].high90,
                  report[m].percentile);
        }
        SIZED(summary);
        OK(anthronet_body_summarise(body, &summary, &fault));
        CHECK(summary.sex == asked[i].sex && summary.seed == asked[i].seed && summary.converged == 1, "summary");
        CHECK(fabs(summary.bmi - summary.mass_kg / (asked[i].height * asked[i].height)) < 0.01, "bmi %f",
              summary.bmi);
        CHECK(summary.solve_residual < TENTH_OF_A_MILLIMETRE, "residual %f", summary.solve_residual);
        OK(anthronet_body_report(body, &json, &fault));
        CHECK(contains_freed(json, "\"obtained\""), "the report has no measures");
        /* Our own look at the mesh, then the library's tape over it. */
        SIZED(options);
        options.layout = ANTHRONET_LAYOUT_MODEL;
        OK(anthronet_mesh_new(body, &options, &mesh, &fault));
        OK(anthronet_mesh_data(mesh, 0, ANTHRONET_ATTRIBUTE_POSITIONS, &view, &fault));
        p = (const float *)view.data;
        for (v = 0; v < view.rows; v++) {
            low = fminf(low, p[3 * v + 1]);
            high = fmaxf(high, p[3 * v + 1]);
        }
        CHECK(fabs(high - asked[i].height) < TENTH_OF_A_MILLIMETRE && fabsf(low) < 1e-5f,
              "asked for %f m, reaches from %f to %f", asked[i].height, (double)low, (double)high);
        SIZED(measured);
        OK(anthronet_measure_mesh(f->model, view.data, (uint32_t)view.rows, 0, ANTHRONET_SPACE_GLTF, metres,
                                  MEASURES, &measured, &fault));
        CHECK(measured.lod == 0 && fabs(measured.mass_kg - summary.mass_kg) < 0.01, "level %u, %f kg", measured.lod,
              measured.mass_kg);
        for (m = 0; m < MEASURES; m++) {
            CHECK(fabs(metres[m] - report[m].obtained) < TENTH_OF_A_MILLIMETRE, "measure %d: %f, on the mesh %f", m,
                  report[m].obtained, metres[m]);
        }
        anthronet_mesh_free(mesh);
        anthronet_body_free(body);
        anthronet_request_free(request);
    }
}

/* The latent numbers of a body make the body again. */
void test_latent(const fixture *f) {
    anthronet_request *request = person(ANTHRONET_SEX_FEMALE, 1.7);
    anthronet_body *seeded = NULL, *by_hand = NULL;
    anthronet_measure_report a[MEASURES], b[MEASURES];
    uint32_t size = 0, m;
    double *latent;
    double largest = 0;
    OK(anthronet_model_latent_size(f->model, &size, &fault));
    latent = (double *)room(size * sizeof *latent);
    OK(anthronet_request_set_seed(request, 17, &fault));
    OK(anthronet_generate(f->model, request, &seeded, &fault));
    OK(anthronet_body_latent(seeded, latent, size, &fault));
    for (m = 0; m < size; m++) largest = fmax(largest, fabs(latent[m]));
    CHECK(largest > 0.1 && largest < 6, "a drawn latent number of %f", largest);
    OK(anthronet_request_set_seed(request, 0, &fault));
    OK(anthronet_request_set_latent(request, latent, size, &fault));
    OK(anthronet_generate(f->model, request, &by_hand, &fault));
    OK(anthronet_body_measures(seeded, a, MEASURES, &fault));
    OK(anthronet_body_measures(by_hand, b, MEASURES, &fault));
    for (m = 0; m < MEASURES; m++) {
        CHECK(fabs(a[m].obtained - b[m].obtained) < 1e-9, "measure %u: %f and %f", m, a[m].obtained, b[m].obtained);
    }
    anthronet_body_free(seeded);
    anthronet_body_free(by_hand);
    anthronet_request_free(request);
    free(latent);
}

void test_interpolate(const fixture *f) {
    anthronet_request *small = person(ANTHRONET_SEX_FEMALE, 1.60), *tall = person(ANTHRONET_SEX_FEMALE, 1.80);
    anthronet_measure_report report[MEASURES];
    int i;
    for (i = 0; i <= 4; i += f->few ? 2 : 1) {
        anthronet_body *body = NULL;
        OK(anthronet_interpolate(f->model, small, tall, i / 4.0, &body, &fault));
        OK(anthronet_body_measures(body, report, MEASURES, &fault));
        CHECK(fabs(report[3].obtained - (1.60 + 0.05 * i)) < TENTH_OF_A_MILLIMETRE, "height %f at %d / 4",
              report[3].obtained, i);
        anthronet_body_free(body);
    }
    anthronet_request_free(small);
    anthronet_request_free(tall);
}

/* What the log heard. */
typedef struct heard {
    int count;
    uint32_t level;
    uint64_t length;
} heard;

static void hear(uint32_t level, const char *message, uint64_t length, void *user) {
    heard *ours = (heard *)user;
    ours->count++;
    ours->level = level;
    ours->length = message != NULL ? length : 0;
}

/* A request that nobody meets: refused, or replaced with a warning that the callback hears. */
void test_log(const fixture *f) {
    anthronet_request *request = nobody();
    anthronet_body *body = NULL;
    anthronet_body_summary summary;
    heard ours;
    ZERO(ours);
    OK(anthronet_set_log_callback(hear, &ours, &fault));
    REFUSED_OUT(ANTHRONET_ERROR_INFEASIBLE, body, anthronet_generate(f->model, request, &body, &fault));
    OK(anthronet_request_set_nearest(request, 1, &fault));
    OK(anthronet_generate(f->model, request, &body, &fault));
    SIZED(summary);
    OK(anthronet_body_summarise(body, &summary, &fault));
    CHECK(summary.warning_count > 0 && ours.count == (int)summary.warning_count, "%u warnings, %d heard",
          summary.warning_count, ours.count);
    CHECK(ours.level == ANTHRONET_LOG_WARNING && ours.length > 0, "level %u", ours.level);
    OK(anthronet_set_log_callback(NULL, NULL, &fault));
    anthronet_body_free(body);
    OK(anthronet_generate(f->model, request, &body, &fault));
    CHECK(ours.count == (int)summary.warning_count, "a callback that was taken back is called");
    anthronet_body_free(body);
    anthronet_request_free(request);
}
