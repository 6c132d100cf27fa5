#include "anthronet/anthronet.hpp"

#include <iostream>

int main() {
  auto model = anthronet::Model::embedded();
  auto request = anthronet::Request::create();
  request->set_sex(anthronet::Sex::Female).set("height", 1.70);
  auto body = model->generate(*request);
  auto scene = body->scene({});
  scene->add_clip(*anthronet::Clip::builtin("walk", *body)).save("person.glb");
  std::cout << body->measure("waist_circumference") << " m\n";
}
