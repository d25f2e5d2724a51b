#pragma once

#include "filasofia/visual/image.h"
#include "filasofia/visual/material.h"
#include "filasofia/visual/material_package.h"

#include <map>
#include <memory>
#include <set>
#include <string_view>

namespace filasofia::visual {

/// A material whose files have all been read and whose numbers have all been checked.
struct ReadyMaterial {
    Material material;                                            ///< never a NamedMaterial
    std::map<std::string, std::shared_ptr<const Image>> pictures; ///< by file
    std::vector<std::string> views;                               ///< whose pictures it shows
    std::shared_ptr<const MaterialPackage> package;               ///< if it is a CustomMaterial
    std::string needsUv;                                          ///< the field that needs uv; empty if none does
    bool needsTangents = false;                                   ///< tangent frames along the uv
};

/// The materials of a server by name, and the files that they and the bodies name, each read once. (Shared pointers,
/// because a backend may still use the data; it never changes.)
class MaterialStore {
public:
    /// Throws an Error that begins with `object` if the material, one of its files, or its name is wrong.
    [[nodiscard]] ReadyMaterial ready(const Material& material, const std::string& object);
    /// The same of the pool's material `pool` with a body's overrides.
    [[nodiscard]] ReadyMaterial ready(const Material& pool, const NamedMaterial& named, const std::string& object);

    void add(const std::string& name, const Material& material);
    /// `material` must be ready.
    void change(const std::string& name, const Material& material) { named_.at(name) = material; }
    void remove(const std::string& name) { named_.erase(name); }
    /// Throws an Error that begins with `object` if there is no such material.
    [[nodiscard]] const Material& get(const std::string& name, const std::string& object) const;

    [[nodiscard]] const std::map<std::string, Material>& all() const { return named_; }

private:
    template <class Held> void requireTextures(const Held& material, const std::string& object, ReadyMaterial& out);
    void requirePicture(const std::string& file, const std::string& object, ReadyMaterial& out);
    void requireNormals(const TextureMap& map, const std::string& object, ReadyMaterial& out);
    /// `field` is what errors call the texture.
    void require(const Texture& texture, const std::string& object, std::string_view field, ReadyMaterial& out);
    void require(const TextureMap& map, const std::string& object, std::string_view field, ReadyMaterial& out);
    void require(const CustomMaterial& material, const std::string& object, ReadyMaterial& out);
    [[nodiscard]] std::shared_ptr<const MaterialPackage> package(const CustomMaterial& material,
                                                                 const std::string& object);

    std::map<std::string, Material> named_;
    std::map<std::string, std::shared_ptr<const Image>> pictures_;
    std::set<std::string> normalMaps_; ///< files whose picture is one
    std::map<std::string, std::shared_ptr<const MaterialPackage>> packages_;
};

} // namespace filasofia::visual
