// A person made from tape measures walks, twice: as the library has it, and after a motion file.
//
//     walk FOLDER
//
// writes walk.glb, walk.usdc and a skinned frame of the walk, and prints what it made.

#include "anthronet/anthronet.hpp"

#include <cmath>
#include <cstdint>
#include <fstream>
#include <future>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

constexpr double pi = 3.14159265358979323846;

// Twenty frames of arms and legs that swing, as any motion capture program writes them: centimetres, degrees.
std::string swing_as_bvh() {
  std::ostringstream bvh;
  bvh << "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\n"
         "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n";
  const std::string turns = "CHANNELS 3 Zrotation Xrotation Yrotation\n";
  const auto joint = [&](const char *name, const char *offset) {
    bvh << "JOINT " << name << "\n{\nOFFSET " << offset << "\n" << turns;
  };
  const auto end = [&](const char *offset, int joints) {
    bvh << "End Site\n{\nOFFSET " << offset << "\n}\n";
    while (joints-- > 0) bvh << "}\n";
  };
  joint("Spine", "0 12 0"), joint("Neck", "0 38 0"), joint("Head", "0 10 0"), end("0 18 0", 2);
  joint("LeftArm", "18 34 0"), joint("LeftForeArm", "28 0 0"), joint("LeftHand", "25 0 0"), end("16 0 0", 3);
  joint("RightArm", "-18 34 0"), joint("RightForeArm", "-28 0 0"), joint("RightHand", "-25 0 0"), end("-16 0 0", 4);
  joint("LeftUpLeg", "10 -2 0"), joint("LeftLeg", "0 -42 0"), joint("LeftFoot", "0 -41 0"), end("0 -6 15", 3);
  joint("RightUpLeg", "-10 -2 0"), joint("RightLeg", "0 -42 0"), joint("RightFoot", "0 -41 0"), end("0 -6 15", 3);
  bvh << "}\nMOTION\nFrames: 20\nFrame Time: 0.05\n";
  for (int frame = 0; frame < 20; ++frame) {
    const double swing = 25.0 * std::sin(2.0 * pi * frame / 20.0);
    const auto still = [&](int joints) {
      for (int i = 0; i < joints; ++i) bvh << " 0 0 0";
    };
    bvh << "0 93 0 0 0 0";
    still(3);  // spine, neck, head
    bvh << " -75 0 " << swing, still(2);
    bvh << " 75 0 " << swing, still(2);
    bvh << " 0 " << swing << " 0", still(2);
    bvh << " 0 " << -swing << " 0", still(2);
    bvh << "\n";
  }
  return bvh.str();
}

template <typename T>
void write(const std::string &path, rust::Slice<const T> numbers) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char *>(numbers.data()),
             static_cast<std::streamsize>(numbers.size() * sizeof(T)));
  if (!file) throw std::runtime_error(path + ": cannot write");
}

void run(const std::string &folder) {
  auto model = anthronet::Model::embedded();
  auto request = anthronet::Request::create();
  request->set_sex(anthronet::Sex::Female)
      .set("height", 1.72)
      .set("waist_circumference", 0.74)
      .set("arm_length", 0.32)
      .set_seed(7);

  // A body takes a few hundredths of a second; a program that draws meanwhile asks for it on another thread.
  auto body = std::async(std::launch::async, [&] { return model->generate(*request); }).get();
  std::cout << std::setprecision(17);
  for (const auto &measure : body->measures()) {
    std::cout << "measure " << measure.name << ' ' << measure.obtained << ' ' << (measure.given ? "given" : "filled")
              << '\n';
  }

  const auto bvh = swing_as_bvh();
  const rust::Slice<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t *>(bvh.data()), bvh.size());
  auto motion = anthronet::Motion::from_bytes(bytes, "swing.bvh", {});
  auto swing = motion->retarget(0, *body, {});
  auto walk = anthronet::Clip::builtin("walk", *body);
  std::cout << "clip " << walk->name() << ' ' << walk->frame_count() << '\n';
  std::cout << "clip " << swing->name() << ' ' << swing->frame_count() << '\n';

  // The tenth frame of the walk, on the CPU. An engine would upload positions, joints and weights instead, once, and the
  // pose every frame.
  auto mesh = body->mesh({});
  auto skinner = mesh->skinner(0);
  std::vector<anthronet::Transform> pose(walk->joint_count());
  const double seconds = 10.0 / walk->frames_per_second();
  auto context = anthronet::Context::create();
  walk->sample(*context, seconds, anthronet::Wrap::Loop, anthronet::Relative::ToModel, anthronet::Space::Gltf,
               rust::Slice<anthronet::Transform>(pose));
  std::vector<float> positions(3 * skinner->vertex_count()), normals(positions.size());
  skinner->skin(*context, anthronet::SkinMethod::Linear, rust::Slice<const anthronet::Transform>(pose),
                rust::Slice<float>(positions), rust::Slice<float>(normals));
  write(folder + "/frame.f32", rust::Slice<const float>(positions));
  write(folder + "/bind.f32", mesh->part(0).positions());
  write(folder + "/triangles.u32", mesh->part(0).triangles());

  auto scene = body->scene({});
  scene->add_clip(*walk).add_clip(*swing);
  scene->save(folder + "/walk.glb");
  scene->save(folder + "/walk.usdc");
}

}  // namespace

int main(int argc, char **argv) {
  if (argc != 2) {
    std::cerr << "usage: walk FOLDER\n";
    return 2;
  }
  try {
    run(argv[1]);
  } catch (const std::exception &error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
