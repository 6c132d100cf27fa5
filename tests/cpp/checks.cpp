// What C++ may rely on: exceptions with the library's message, lifetimes, threads, enumerations, and the same bytes as
// the command line.
//
//     checks REQUEST.json EXPECTED.glb FOLDER SAME_BYTES
//
// SAME_BYTES is the folder that ffi/tests/same_bytes.rs leaves, and says how it is read.

#include "../c/sha256.h"
#include "anthronet/anthronet.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iostream>
#include <iterator>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

namespace {

using namespace anthronet;

// One for all checks that are not about threads.
auto context = Context::create();

bool all_passed = true;

void check(bool holds, const std::string &why) {
  if (!holds) throw std::runtime_error(why);
}

void test(const std::string &name, const std::function<void()> &body) {
  try {
    body();
    std::cout << "ok C++: " << name << std::endl;
  } catch (const std::exception &error) {
    all_passed = false;
    std::cout << "FAILED C++: " << name << ": " << error.what() << std::endl;
  }
}

// Fails unless `work` throws an error of the library whose message has all these words.
void throws(const std::vector<std::string> &words, const std::function<void()> &work) {
  try {
    work();
  } catch (const rust::Error &error) {
    const std::string message = error.what();
    for (const auto &word : words)
      check(message.find(word) != std::string::npos, "expected `" + word + "` in: " + message);
    return;
  }
  throw std::runtime_error("expected an exception about " + words.front());
}

std::string read(const std::string &path) {
  std::ifstream file(path, std::ios::binary);
  check(static_cast<bool>(file), path + ": cannot read");
  return {std::istreambuf_iterator<char>(file), {}};
}

rust::Box<Body> person(const Model &model, double height) {
  auto request = Request::create();
  request->set_sex(Sex::Female).set("height", height);
  return model.generate(*request);
}

bool same(const rust::Vec<std::uint8_t> &bytes, const std::string &expected) {
  return bytes.size() == expected.size() && std::equal(bytes.begin(), bytes.end(), expected.begin(), [](auto a, auto b) {
           return a == static_cast<std::uint8_t>(b);
         });
}

void exceptions(const Model &model, const std::string &folder) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  auto request = Request::create();
  test("a request that is no JSON throws", [] { throws({"expected"}, [] { Request::from_json("{\"height\""); }); });
  test("an unknown field throws", [] {
    throws({"hight", "height"}, [] { Request::from_json(R"({"measures": {"hight": 1.7}})"); });
  });
  test("NaN throws and changes nothing", [&] {
    const auto before = request->to_json();
    throws({"height", "finite"}, [&] { request->set("height", nan); });
    throws({"latent 1", "finite"}, [&] {
      const double latent[] = {0.0, nan};
      request->set_latent(rust::Slice<const double>(latent, 2));
    });
    check(before == request->to_json(), "the request changed");
  });
  test("centimetres throw with a hint", [&] {
    auto tall = Request::create();
    tall->set("height", 170.0);
    throws({"height", "1.7"}, [&] { model.generate(*tall); });
  });
  test("measures that nobody has throw", [&] {
    auto impossible = Request::create();
    impossible->set_sex(Sex::Male).set("height", 1.50).set("calf_length", 0.48).set("thigh_length", 0.52);
    throws({"calf_length", "nearest feasible"}, [&] { model.generate(*impossible); });
    impossible->set_nearest(true);
    check(!model.generate(*impossible)->warnings().empty(), "expected a warning");
  });
  test("missing files throw by name", [&] {
    throws({"missing.safetensors"}, [&] { Model::open(folder + "/missing.safetensors"); });
    throws({"missing.bvh"}, [&] { Motion::open(folder + "/missing.bvh", {}); });
    throws({"missing.glb"}, [&] { model.measure_file(folder + "/missing.glb"); });
    throws({"missing/a.glb"}, [&] { person(model, 1.70)->save(folder + "/missing/a.glb"); });
  });
  test("damaged bytes throw", [] {
    const std::vector<std::uint8_t> bytes(100, 7);
    throws({"model"}, [&] { Model::from_bytes(rust::Slice<const std::uint8_t>(bytes)); });
    throws({"a.bvh"}, [&] { Motion::from_bytes(rust::Slice<const std::uint8_t>(bytes), "a.bvh", {}); });
    throws({"model"}, [] { Model::from_bytes({}); });
  });
  test("values that no enumeration has throw", [&] {
    auto body = person(model, 1.70);
    throws({"space", "number 9"}, [&] { body->joints(static_cast<Space>(9)); });
    throws({"sex", "number 9"}, [&] { request->set_sex(static_cast<Sex>(9)); });
    MeshOptions options;
    options.space = Space::Gltf;
    options.layout = static_cast<Layout>(9);
    throws({"layout", "number 9"}, [&] { body->mesh(options); });
    options.layout = Layout::Render;
    options.lod = 4;
    throws({"lod", "got 4"}, [&] { body->mesh(options); });
    options.lod = 0;
    options.influences = 5;
    throws({"5"}, [&] { body->mesh(options); });
  });
  test("indices and names beyond the last throw", [&] {
    auto body = person(model, 1.70);
    throws({"part", "got 99"}, [&] { body->mesh({})->part(99); });
    throws({"joint", "got 999"}, [&] { body->joint_name(999, JointNames::Unity); });
    throws({"waste"}, [&] { body->measure("waste"); });
    throws({"moonwalk"}, [&] { Clip::builtin("moonwalk", *body); });
    throws({"stl"}, [&] { body->scene({})->to_bytes("stl"); });
  });
  test("text that is not UTF-8 throws", [] {
    bool thrown = false;
    try {
      Request::from_json(std::string("\xff\xfe"));
    } catch (const std::exception &) {
      thrown = true;
    }
    check(thrown, "expected an exception");
  });
}

void buffers(const Model &model) {
  test("buffers of a wrong size throw and stay as they are", [&] {
    auto body = person(model, 1.70);
    auto clip = Clip::builtin("idle", *body);
    std::vector<Transform> pose(clip->joint_count() - 1);
    const rust::Slice<Transform> few(pose);
    throws({"transforms"}, [&] { clip->sample(*context, 0.0, Wrap::Once, Relative::ToModel, Space::Gltf, few); });
    throws({"transforms"}, [&] { clip->bake(Relative::ToModel, Space::Gltf, few); });
    pose.resize(clip->joint_count());
    throws({"seconds"}, [&] {
      clip->sample(*context, std::nan(""), Wrap::Once, Relative::ToModel, Space::Gltf, rust::Slice<Transform>(pose));
    });
    clip->sample(*context, 0.0, Wrap::Once, Relative::ToModel, Space::Gltf, rust::Slice<Transform>(pose));
    auto skinner = body->mesh({})->skinner(0);
    std::vector<float> small(3 * skinner->vertex_count() - 1, 7.0F);
    throws({"buffer"}, [&] {
      skinner->skin(*context, SkinMethod::Linear, rust::Slice<const Transform>(pose), rust::Slice<float>(small), {});
    });
    check(std::all_of(small.begin(), small.end(), [](float v) { return v == 7.0F; }), "something was written");
    throws({"three numbers"}, [&] { model.measure_mesh(rust::Slice<const float>(small), Space::Gltf); });
  });
  test("the same surface in three spaces, at four levels of detail, in two layouts", [&] {
    auto body = person(model, 1.70);
    for (std::uint32_t lod = 0; lod < 4; ++lod) {
      MeshOptions options{};
      options.lod = lod;
      options.layout = Layout::Model;
      auto ours = body->mesh(options);
      const MeshPart &part = ours->part(0);
      check(part.vertex_count() == model.vertex_count(lod), "number of vertices");
      check(part.positions().size() == 3 * part.vertex_count(), "number of positions");
      check(part.weights().size() == part.influences() * part.vertex_count(), "number of weights");
      for (const Space space : {Space::Blender, Space::Unity}) {
        options.space = space;
        auto theirs = body->mesh(options);
        const auto a = part.positions(), b = theirs->part(0).positions();
        for (std::size_t v = 0; v < a.size(); v += 3) {
          const bool blender = space == Space::Blender;
          const float expected[] = {blender ? a[v] : -a[v], blender ? -a[v + 2] : a[v + 1], blender ? a[v + 1] : a[v + 2]};
          check(std::equal(expected, expected + 3, b.data() + v), "position " + std::to_string(v / 3));
        }
        const auto measured = model.measure_mesh(b, space);
        check(measured.lod == lod, "level of detail");
        // Level 3 has 800 vertices of 53,514.
        check(std::abs(measured.metres[3] - 1.70) < 1e-4, "height " + std::to_string(measured.metres[3]));
      }
      options.space = Space::Gltf;
      options.layout = Layout::Render;
      auto drawn = body->mesh(options);
      const MeshPart &render = drawn->part(0);
      const auto triangles = render.triangles();
      check(!triangles.empty() && triangles.size() % 3 == 0, "triangles");
      check(*std::max_element(triangles.begin(), triangles.end()) < render.vertex_count(), "vertex of a triangle");
      check(render.uvs().size() == 2 * render.vertex_count(), "texture coordinates");
      check(render.quads().empty(), "quads");
      for (std::size_t v = 0; v < render.vertex_count(); ++v) {
        const auto source = render.sources()[v];
        check(std::equal(render.positions().data() + 3 * v, render.positions().data() + 3 * v + 3,
                         part.positions().data() + 3 * source),
              "source of vertex " + std::to_string(v));
      }
    }
  });
  test("many characters in a call are skinned as one by one", [&] {
    auto body = person(model, 1.62);
    auto mesh = body->mesh({});
    auto clip = Clip::builtin("wave", *body);
    std::vector<rust::Box<Skinner>> skinners;
    std::vector<std::vector<float>> together(mesh->part_count()), normals(mesh->part_count());
    std::vector<Transform> pose(clip->joint_count());
    clip->sample(*context, 0.7, Wrap::Loop, Relative::ToModel, Space::Gltf, rust::Slice<Transform>(pose));
    std::vector<SkinJob> jobs;
    for (std::size_t part = 0; part < mesh->part_count(); ++part) {
      skinners.push_back(mesh->skinner(part));
      together[part].resize(3 * skinners[part]->vertex_count());
      normals[part].resize(together[part].size());
    }
    for (std::size_t part = 0; part < skinners.size(); ++part)
      jobs.push_back({*skinners[part], SkinMethod::DualQuaternion, rust::Slice<const Transform>(pose), {},
                      rust::Slice<float>(together[part]), rust::Slice<float>(normals[part])});
    skin_many(*context, rust::Slice<SkinJob>(jobs));
    for (std::size_t part = 0; part < skinners.size(); ++part) {
      std::vector<float> alone(together[part].size());
      skinners[part]->skin(*context, SkinMethod::DualQuaternion, rust::Slice<const Transform>(pose), rust::Slice<float>(alone), {});
      check(alone == together[part], "part " + std::to_string(part));
    }
    const std::vector<float> lift(together[0].size(), 0.25F);
    SkinJob lifted{*skinners[0], SkinMethod::JointTranslation, rust::Slice<const Transform>(pose),
                   rust::Slice<const float>(lift), rust::Slice<float>(together[0]), {}};
    std::vector<float> plain(lift.size());
    skinners[0]->skin(*context, SkinMethod::JointTranslation, rust::Slice<const Transform>(pose), rust::Slice<float>(plain), {});
    skin_many(*context, rust::Slice<SkinJob>(&lifted, 1));
    for (std::size_t i = 0; i < plain.size(); ++i)
      check(std::abs(together[0][i] - plain[i] - 0.25F) < 1e-5F, "offset of " + std::to_string(i));
  });
}

void interleaved(const Model &model) {
  auto body = person(model, 1.70);
  auto mesh = body->mesh({});
  auto skinner = mesh->skinner(0);
  auto walk = Clip::builtin("walk", *body);
  std::vector<Transform> pose(walk->joint_count());
  walk->sample(*context, 0.4, Wrap::Loop, Relative::ToModel, Space::Gltf, rust::Slice<Transform>(pose));
  const rust::Slice<const Transform> posed(pose);
  const std::size_t count = skinner->vertex_count();
  std::vector<float> positions(3 * count), normals(3 * count);
  skinner->skin(*context, SkinMethod::Linear, posed, rust::Slice<float>(positions), rust::Slice<float>(normals));

  test("a vertex buffer is skinned in place of two arrays", [&] {
    struct Vertex {
      float uv[2], normal[3], position[3];
    };
    std::vector<Vertex> vertices(count, Vertex{{7.0F, 8.0F}, {}, {}});
    const rust::Slice<std::uint8_t> bytes(reinterpret_cast<std::uint8_t *>(vertices.data()), count * sizeof(Vertex));
    skinner->skin_interleaved(*context, SkinMethod::Linear, posed, {}, bytes, sizeof(Vertex), offsetof(Vertex, position),
                              offsetof(Vertex, normal));
    for (std::size_t v = 0; v < count; ++v) {
      check(std::equal(vertices[v].position, vertices[v].position + 3, positions.data() + 3 * v), "position");
      check(std::equal(vertices[v].normal, vertices[v].normal + 3, normals.data() + 3 * v), "normal");
      check(vertices[v].uv[0] == 7.0F && vertices[v].uv[1] == 8.0F, "what is between");
    }
    const std::vector<float> lift(3 * count, 0.25F);
    skinner->skin_interleaved(*context, SkinMethod::JointTranslation, posed, rust::Slice<const float>(lift), bytes, sizeof(Vertex),
                              offsetof(Vertex, position), offsetof(Vertex, normal));
    std::vector<float> plain(3 * count);
    skinner->skin(*context, SkinMethod::JointTranslation, posed, rust::Slice<float>(plain), {});
    check(std::abs(vertices[9].position[1] - plain[28] - 0.25F) < 1e-5F, "offset");
    throws({"stride"}, [&] { skinner->skin_interleaved(*context, SkinMethod::Linear, posed, {}, bytes, 20, 0, 12); });
    throws({"vertex buffer"}, [&] { skinner->skin_interleaved(*context, SkinMethod::Linear, posed, {}, bytes, 33, 0, 12); });
    throws({"offsets"}, [&] {
      skinner->skin_interleaved(*context, SkinMethod::Linear, posed, rust::Slice<const float>(lift.data(), 3), bytes, 32, 0, 12);
    });
  });
  test("buffers that overlap throw", [&] {
    std::vector<float> both(6 * count, 7.0F);
    std::vector<SkinJob> jobs;
    for (const std::size_t first : {std::size_t{0}, 3 * count - 1})
      jobs.push_back({*skinner, SkinMethod::Linear, posed, {}, rust::Slice<float>(both.data() + first, 3 * count), {}});
    throws({"of its own", "positions of job 0", "positions of 1"}, [&] { skin_many(*context, rust::Slice<SkinJob>(jobs)); });
    check(std::all_of(both.begin(), both.end(), [](float v) { return v == 7.0F; }), "something was written");
    jobs[1].positions = rust::Slice<float>(both.data() + 3 * count, 3 * count);
    skin_many(*context, rust::Slice<SkinJob>(jobs));
    check(std::equal(positions.begin(), positions.end(), both.begin() + static_cast<std::ptrdiff_t>(3 * count)), "side by side");
  });
}

void layers(const Model &model) {
  test("masks and layers move what they cover", [&] {
    auto body = person(model, 1.70);
    auto walk = Clip::builtin("walk", *body), idle = Clip::builtin("idle", *body);
    const auto joints = walk->joint_count();
    const auto mask = walk->joint_mask("spine_01");
    check(mask.size() == joints, "number of joints");
    const auto frame = [&](const Clip &clip) {
      std::vector<Transform> pose(joints);
      clip.sample(*context, 0.3, Wrap::Once, Relative::ToParent, Space::Gltf, rust::Slice<Transform>(pose));
      return pose;
    };
    const auto apart = [](const Transform &a, const Transform &b) {
      float most = 0.0F;
      for (std::size_t k = 0; k < 4; ++k) most = std::max(most, std::abs(a.rotation[k] - b.rotation[k]));
      return most;
    };
    const rust::Slice<const float> shares(mask);
    const auto walking = frame(*walk), standing = frame(*idle);
    const auto mixed = frame(*walk->blend_masked(*idle, 1.0F, shares));
    const auto layered = frame(*idle->additive(*walk, 1.0F, shares));
    float moved = 0.0F;
    for (std::size_t j = 0; j < joints; ++j) {
      check(apart(mixed[j], mask[j] == 1.0F ? standing[j] : walking[j]) < 1e-4F, "joint " + std::to_string(j));
      if (mask[j] == 0.0F) check(apart(layered[j], standing[j]) < 1e-4F, "layer at joint " + std::to_string(j));
      else moved = std::max(moved, apart(layered[j], standing[j]));
    }
    check(moved > 0.01F, "the layer moves nothing");
    check(idle->additive(*walk, 0.5F, {})->frame_count() == idle->frame_count(), "a layer of every joint");
    throws({"tail"}, [&] { walk->joint_mask("tail"); });
    throws({"joint mask"}, [&] { walk->blend_masked(*idle, 1.0F, rust::Slice<const float>(mask.data(), 3)); });
    throws({"weight"}, [&] { walk->additive(*idle, std::nanf(""), {}); });
  });
}

// The list of all hosts, whose errors have codes that C++ has not: it has to fail where they do.
void same_bytes(const Model &model, const std::string &folder) {
  test("same bytes: 200 requests through C++ and cxx", [&] {
    std::istringstream requests(read(folder + "/requests.jsonl")), hashes(read(folder + "/sha256.txt"));
    std::size_t number = 0;
    for (std::string request, expected; std::getline(requests, request); ++number) {
      check(static_cast<bool>(std::getline(hashes, expected)), "fewer hashes than requests");
      std::string got = "error";
      try {
        auto body = model.generate(*Request::from_json(request));
        SceneOptions options{};
        options.lod = static_cast<std::uint32_t>(number % 4);
        auto scene = body->scene(options);
        if (number % 10 == 3) scene->add_clip(*Clip::builtin("walk", *body));
        const auto bytes = scene->to_bytes("glb");
        char hash[65];
        sha256(bytes.data(), bytes.size(), hash);
        got = hash;
      } catch (const rust::Error &) {
      }
      check(got == expected.substr(0, expected.find(' ')), "request " + std::to_string(number) + ": " + got);
    }
    check(number >= 200, std::to_string(number) + " requests");
  });
}

void motion(const Model &model) {
  test("clips are sampled, baked and changed", [&] {
    auto body = person(model, 1.70);
    auto walk = Clip::builtin("walk", *body), wave = Clip::builtin("wave", *body);
    const auto joints = walk->joint_count();
    check(joints == body->summary().joint_count, "number of joints");
    std::vector<Transform> all(walk->frame_count() * joints), one(joints);
    walk->bake(Relative::ToParent, Space::Unity, rust::Slice<Transform>(all));
    walk->sample(*context, 3 / walk->frames_per_second(), Wrap::Once, Relative::ToParent, Space::Unity,
                 rust::Slice<Transform>(one));
    for (std::size_t j = 0; j < joints; ++j) check(one[j].rotation == all[3 * joints + j].rotation, "frame 3");
    check(walk->resample(60.0)->frames_per_second() == 60.0, "rate");
    check(std::abs(walk->resample(60.0)->duration() - walk->duration()) < 0.02, "duration");
    throws({"0"}, [&] { walk->resample(0.0); });
    check(walk->crossfade(*wave, 0.3)->duration() > walk->duration(), "crossfade");
    check(walk->blend(*wave, 0.5F)->joint_count() == joints, "blend");
    throws({"weight"}, [&] { walk->blend(*wave, std::nanf("")); });
    check(walk->in_place()->frame_count() == walk->frame_count(), "in place");
    check(walk->looped(0.2)->frame_count() > 1, "looped");
    check(std::string(walk->renamed("stroll")->name()) == "stroll", "name");
    auto scene = body->scene({});
    scene->add_clip(*walk);
    throws({"walk", "unique"}, [&] { scene->add_clip(*walk); });
  });
  test("a pose moves the same surface in three spaces", [&] {
    auto body = person(model, 1.70);
    auto walk = Clip::builtin("walk", *body);
    std::vector<Transform> pose(walk->joint_count());
    std::vector<std::vector<float>> skinned;
    for (const Space space : {Space::Gltf, Space::Blender, Space::Unity}) {
      MeshOptions options{};
      options.lod = 1;
      options.space = space;
      auto skinner = body->mesh(options)->skinner(0);
      walk->sample(*context, 0.4, Wrap::Loop, Relative::ToModel, space, rust::Slice<Transform>(pose));
      skinned.emplace_back(3 * skinner->vertex_count());
      skinner->skin(*context, SkinMethod::Linear, rust::Slice<const Transform>(pose), rust::Slice<float>(skinned.back()), {});
    }
    for (std::size_t i = 0; i < skinned[0].size(); i += 3) {
      const float *ours = &skinned[0][i], *blender = &skinned[1][i], *unity = &skinned[2][i];
      const float off[] = {blender[0] - ours[0], blender[1] + ours[2], blender[2] - ours[1],
                           unity[0] + ours[0],   unity[1] - ours[1],   unity[2] - ours[2]};
      check(std::all_of(off, off + 6, [](float v) { return std::abs(v) < 2e-6F; }), "vertex " + std::to_string(i / 3));
    }
  });
  test("a motion file of the library's own comes back", [&] {
    auto body = person(model, 1.70);
    auto scene = body->scene({});
    scene->add_clip(*Clip::builtin("squat", *body));
    const auto glb = scene->to_bytes("glb");
    auto read = Motion::from_bytes(rust::Slice<const std::uint8_t>(glb), "squat.glb", {});
    check(read->clip_count() == 1 && std::string(read->clip_name(0)) == "squat", "its clip");
    check(std::string(read->report()).find("\"unit\"") != std::string::npos, "its report");
    RetargetOptions options{};
    options.in_place = true;
    options.frames_per_second = 15.0;
    auto there = read->retarget(0, *person(model, 1.85), options);
    check(there->frames_per_second() == 15.0, "rate");
    check(std::string(there->report()).find("\"scale\"") != std::string::npos, "report");
    check(std::string(there->report()).find("\"doubts\":[]") != std::string::npos, "doubts about a person");
    MotionOptions second{};
    second.person = 2;
    throws({"person", "got 1"}, [&] { Motion::from_bytes(rust::Slice<const std::uint8_t>(glb), "squat.glb", second); });
    options.mapping_json = "{";
    throws({"mapping_json"}, [&] { read->retarget(0, *body, options); });
    throws({"clip", "got 1"}, [&] { read->retarget(1, *body, {}); });
  });
}

void lifetimes(const Model &shared) {
  test("a body outlives its model, a skinner its mesh, a clip its body", [] {
    auto model = Model::embedded();
    auto body = person(*model, 1.66);
    { auto gone = std::move(model); }
    auto mesh = body->mesh({});
    auto skinner = mesh->skinner(0);
    auto clip = Clip::builtin("walk", *body);
    const auto view = mesh->part(0).positions();
    const std::vector<float> bind(view.begin(), view.end());
    { auto gone = std::move(body); }
    check(std::equal(view.begin(), view.end(), bind.begin()), "the mesh changed with its body");
    { auto gone = std::move(mesh); }
    std::vector<Transform> pose(clip->joint_count());
    clip->sample(*context, 0.5, Wrap::Once, Relative::ToModel, Space::Gltf, rust::Slice<Transform>(pose));
    std::vector<float> positions(bind.size());
    skinner->skin(*context, SkinMethod::Linear, rust::Slice<const Transform>(pose), rust::Slice<float>(positions), {});
    check(positions != bind, "nothing moved");
  });
  test("slices alias: asked twice, the same memory", [&] {
    auto body = person(shared, 1.70);
    auto mesh = body->mesh({});
    check(mesh->part(0).positions().data() == mesh->part(0).positions().data(), "copied positions");
    check(&mesh->part(0) == &mesh->part(0), "copied part");
    check(body->latent().data() == body->latent().data() && body->latent().size() == shared.latent_size(), "latent");
  });
  test("eight threads on one model make what one makes", [&] {
    const auto bytes = [&](int i) { return person(shared, 1.55 + 0.04 * i)->scene({})->to_bytes("glb"); };
    std::vector<std::string> together(8);
    std::vector<std::thread> threads;
    for (int i = 0; i < 8; ++i)
      threads.emplace_back([&, i] {
        const auto made = bytes(i);
        together[static_cast<std::size_t>(i)].assign(made.begin(), made.end());
      });
    for (auto &thread : threads) thread.join();
    for (int i = 0; i < 8; ++i) check(same(bytes(i), together[static_cast<std::size_t>(i)]), "thread " + std::to_string(i));
  });
}

void requests_and_reports(const Model &model) {
  test("requests in setters and in JSON are the same", [&] {
    auto set = Request::create();
    set->set_sex(Sex::Male).set("height", 1.80).set("arm_length", 0.33).set_seed(5).set_fill(Fill::Sample);
    auto text = Request::from_json(set->to_json());
    check(set->to_json() == text->to_json(), "JSON");
    check(set->copy()->to_json() == set->to_json(), "copy");
    check(same(model.generate(*set)->scene({})->to_bytes("glb"),
               [&] {
                 const auto bytes = model.generate(*text)->scene({})->to_bytes("glb");
                 return std::string(bytes.begin(), bytes.end());
               }()),
          "bytes");
    text->unset("arm_length");
    check(text->to_json() != set->to_json(), "unset");
    throws({"lenght"}, [&] { text->unset("lenght"); });
  });
  test("reports say what was asked", [&] {
    auto body = person(model, 1.74);
    const auto names = measure_names();
    const auto measures = body->measures();
    check(!names.empty() && measures.size() == names.size(), "number of measures");
    for (std::size_t i = 0; i < names.size(); ++i) {
      const bool height = names[i] == "height";
      check(measures[i].name == names[i] && measures[i].given == height, "measure " + std::string(names[i]));
      const auto range = model.measure_range(names[i]);
      check(range.min < measures[i].obtained && measures[i].obtained < range.max, "range of " + std::string(names[i]));
    }
    check(std::abs(body->measure("height") - 1.74) < 1e-4, "height");
    const auto summary = body->summary();
    check(summary.sex == Sex::Female && summary.converged && summary.mass_kg > 30.0, "summary");
    check(std::string(body->report()).find("\"height\"") != std::string::npos, "report");
    check(std::string(model.info()).find("\"measures\"") != std::string::npos, "info");
    check(body->warnings().empty(), "warnings");
  });
  test("between two people", [&] {
    auto small = Request::create(), tall = Request::create();
    small->set_sex(Sex::Female).set("height", 1.55);
    tall->set_sex(Sex::Female).set("height", 1.75);
    check(std::abs(model.interpolate(*small, *tall, 0.25)->measure("height") - 1.60) < 1e-3, "height");
    throws({"t:"}, [&] { model.interpolate(*small, *tall, std::nan("")); });
  });
  test("joints have their names and matrices", [&] {
    auto body = person(model, 1.70);
    const auto joints = body->joints(Space::Gltf);
    check(joints[0].parent == -1, "root");
    std::size_t found = 0;
    for (std::size_t j = 0; j < joints.size(); ++j) {
      check(joints[j].parent < static_cast<int>(j), "parents first");
      for (const auto &bone : humanoid_bones())
        if (bone.native == joints[j].name) {
          check(body->joint_name(j, JointNames::Unity) == bone.unity, "name of " + std::string(bone.native));
          ++found;
        }
    }
    check(found == humanoid_bones().size() && found == 55, "humanoid bones");
  });
  test("a blend shape leads to the other body", [&] {
    auto from = person(model, 1.60)->mesh({}), to = person(model, 1.80)->mesh({});
    const auto shape = from->part(0).blend_shape("tall", to->part(0));
    const auto a = from->part(0).positions(), b = to->part(0).positions();
    for (std::size_t i = 0; i < a.size(); ++i) check(std::abs(a[i] + shape.positions[i] - b[i]) < 1e-6F, "vertex");
    throws({"vertices"}, [&] { from->part(0).blend_shape("eyes", from->part(1)); });
  });
}

}  // namespace

int main(int argc, char **argv) {
  if (argc != 5) {
    std::cerr << "usage: checks REQUEST.json EXPECTED.glb FOLDER SAME_BYTES\n";
    return 2;
  }
  static_assert(!std::is_copy_constructible_v<rust::Box<Model>>, "what owns is not copied");
  auto model = Model::embedded();
  exceptions(*model, argv[3]);
  buffers(*model);
  interleaved(*model);
  layers(*model);
  same_bytes(*model, argv[4]);
  motion(*model);
  lifetimes(*model);
  requests_and_reports(*model);
  test("the same bytes as the command line", [&] {
    auto body = model->generate(*Request::from_json(read(argv[1])));
    check(same(body->scene({})->to_bytes("glb"), read(argv[2])), "the files differ");
    const std::string path = std::string(argv[3]) + "/saved.glb";
    body->save(path);
    check(read(path) == read(argv[2]), "the saved file differs");
    const auto measured = model->measure_file(path);
    check(std::abs(measured.mass_kg - body->summary().mass_kg) < 1e-3, "mass of the file");
    check(measured.warnings.empty(), "warnings of the file");
  });
  test("the version is that of the package", [] { check(std::string(version()) == ANTHRONET_VERSION, std::string(version())); });
  return all_passed ? 0 : 1;
}
