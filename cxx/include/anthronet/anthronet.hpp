// AnthroNet for C++17: type tape measures, get a rigged, skinned, animated person.
// SPDX-License-Identifier: MIT OR Apache-2.0
//
// Everything is in the namespace `anthronet` and declared in "anthronet/bridge.h", with its comments.
//
// Objects come in `rust::Box<T>`, which owns like `std::unique_ptr` and frees what it holds; they need the objects that
// they were made of no longer. Functions that can fail throw `rust::Error`, a `std::exception` whose `what()` names what
// was wrong and what was expected; nothing is half done then. `rust::Slice<const T>` views an array of the object that
// was asked, as long as that lives; `rust::Slice<T>` is a buffer of yours that is filled, and is made of any container
// that has `data()` and `size()`. `rust::Str` is made of a `std::string` or a literal, in UTF-8.
//
// Const member functions may be called by many threads at once, for there is no state that they change but that of the
// `Context` that some take: one call at a time may use it.
//
// Metres, radians, seconds, kilograms. Axes and handedness are those of the `Space` of the call. Matrices are column-major and
// multiply column vectors; quaternions are x, y, z, w.

#pragma once

#include "anthronet/bridge.h"
#include "rust/cxx.h"
