// The hashes of the files of a list of requests, as C++ programs hold handles; ffi/tests/same_bytes.rs says how.
// Argument: the list.

#include "../../ffi/include/anthronet.h"
#include "sha256.h"

#include <fstream>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

namespace {

/// Frees a handle with the function of its kind.
template <auto Free> struct Freed {
    template <class T> void operator()(T *handle) const { Free(handle); }
};

using Model = std::unique_ptr<anthronet_model, Freed<anthronet_model_free>>;
using Request = std::unique_ptr<anthronet_request, Freed<anthronet_request_free>>;
using Body = std::unique_ptr<anthronet_body, Freed<anthronet_body_free>>;
using Clip = std::unique_ptr<anthronet_clip, Freed<anthronet_clip_free>>;
using Bytes = std::unique_ptr<anthronet_bytes, Freed<anthronet_bytes_free>>;

struct Failure : std::runtime_error {
    explicit Failure(const anthronet_error &error) : std::runtime_error(error.message), code(error.code) {}
    std::int32_t code;
};

/// Calls a function that makes something or fails.
template <class Handle, class Make> Handle made(Make make) {
    typename Handle::pointer handle = nullptr;
    anthronet_error error{};
    if (make(&handle, &error) != ANTHRONET_OK) throw Failure(error);
    return Handle(handle);
}

std::string hash_of(const Model &model, std::string_view json, std::uint32_t number) {
    auto request = made<Request>([&](auto out, auto error) {
        return anthronet_request_from_json(json.data(), json.size(), out, error);
    });
    auto body = made<Body>([&](auto out, auto error) {
        return anthronet_generate(model.get(), request.get(), out, error);
    });
    anthronet_export_options options{};
    options.struct_size = sizeof options;
    options.lod = number % 4;
    Clip walk;
    const anthronet_clip *clips[1];
    if (number % 10 == 3) {
        walk = made<Clip>([&](auto out, auto error) {
            return anthronet_clip_builtin("walk", 4, body.get(), out, error);
        });
        clips[0] = walk.get();
        options.clips = clips;
        options.clip_count = 1;
    }
    auto bytes = made<Bytes>([&](auto out, auto error) {
        return anthronet_export_memory(body.get(), &options, "glb", 3, out, error);
    });
    const std::uint8_t *data = nullptr;
    std::uint64_t length = 0;
    if (anthronet_error error{}; anthronet_bytes_data(bytes.get(), &data, &length, &error) != ANTHRONET_OK) {
        throw Failure(error);
    }
    char text[65];
    sha256(data, length, text);
    return text;
}

}  // namespace

int main(int argc, char **argv) {
    std::ifstream list(argc == 2 ? argv[1] : "");
    if (!list) {
        std::cerr << "usage: " << argv[0] << " REQUESTS\n";
        return 2;
    }
    auto model = made<Model>([](auto out, auto error) { return anthronet_model_open_embedded(out, error); });
    std::uint32_t number = 0;
    for (std::string line; std::getline(list, line); number++) {
        try {
            std::cout << hash_of(model, line, number) << '\n';
        } catch (const Failure &failure) {
            std::cout << "error " << failure.code << '\n';
        }
    }
}
