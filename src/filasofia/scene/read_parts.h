#pragma once

#include "filasofia/record/json_reader.h"
#include "filasofia/scene/def_shapes.h"
#include "filasofia/scene/json_source.h"

#include <string>
#include <string_view>
#include <vector>

/// The parts of what SceneReader reads, without their types.
namespace filasofia::scene {

using record::Place;
class SceneReader;

/// A value that a file says of a thing, itself or as a default.
struct Layer {
    const Json* json = nullptr;
    int rank = 0; ///< lower ones come first: 0 is what the thing says itself
};
/// A value and the defaults behind it, the most specific first.
using Layers = std::vector<Layer>;

/// A member of an object that is read. Without types: the code for each member of each Def, inlined into that for
/// its Def, took twice as long to compile.
struct ReadMember {
    std::string_view name; ///< empty: its members stand beside the others
    Bound bound;
    void* value = nullptr;
    void (SceneReader::*read)(const Layers& from, const Place& place, const Bound& bound, void* value) = nullptr;
    void (SceneReader::*readBeside)(const Layers& from, const Place& place, const std::vector<std::string>& known,
                                    void* value) = nullptr;
    void (SceneReader::*fill)(const Place& place, void* value) = nullptr;
};
using ReadMembers = std::vector<ReadMember>;

/// An object that is being read.
struct OpenedObject {
    std::size_t classes = 0; ///< that were open before
    Layers layers;
    std::vector<std::string> known; ///< the names that its members may have
};
/// What an object of a type must be, whatever its members are.
struct ObjectShape {
    std::string_view type;
    std::vector<std::string_view> required;
    bool flat = false; ///< kFlat
};

/// An alternative of a variant that is read.
struct ReadAlternative {
    std::string_view type = {}; ///< empty: no Def, but a plain value
    bool material = false;      ///< FemMaterial, which may be the name of a tissue
    void (SceneReader::*read)(const Layers& from, const Place& place, const std::vector<std::string>& beside,
                              void* variant) = nullptr;
    void (*makeDefault)(void* variant) = nullptr;
    bool (*takes)(const Json& json) = nullptr; ///< null: none is a plain value of this type
    /// Null, but for a TextureFile, which may be the name of its file.
    void (SceneReader::*readFile)(const Json& json, const Place& place, void* variant) = nullptr;
    void (SceneReader::*readPlain)(const Layers& from, const Place& place, const Bound& bound, void* variant) = nullptr;
};
using ReadAlternatives = std::vector<ReadAlternative>;

} // namespace filasofia::scene
