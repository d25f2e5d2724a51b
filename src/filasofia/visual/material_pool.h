#pragma once

#include "filasofia/visual/filament_textures.h"

#include <filament/Engine.h>
#include <filament/Material.h>
#include <filament/MaterialInstance.h>

#include <map>
#include <string>

namespace filasofia::visual {

/// The compiled materials of this library and of the user, each loaded at its first use. Filament ends the process on a
/// wrong material or parameter; here each of these is an Error.
class MaterialPool {
public:
    explicit MaterialPool(filament::Engine& engine) : engine_(engine), textures_(engine) {}
    MaterialPool(const MaterialPool&) = delete;
    MaterialPool& operator=(const MaterialPool&) = delete;
    /// All instances must have been destroyed before.
    ~MaterialPool();

    /// One of the library's own: "tissue", "metal", ...
    filament::Material& get(const std::string& name);
    /// An instance with this look; the caller destroys it.
    filament::MaterialInstance* instance(const ReadyMaterial& material);
    /// Changes an instance of the material with the same name in the pool.
    void apply(const ReadyMaterial& material, filament::MaterialInstance& instance);
    /// The material's name in the pool. If an instance cannot be changed from one material to another, their names
    /// differ.
    static std::string nameOf(const Material& material);
    [[nodiscard]] TexturePool& textures() { return textures_; }

private:
    filament::Material& get(const CustomMaterial& material, const MaterialPackage& package);
    filament::Material& load(const std::string& name, const std::uint8_t* bytes, std::size_t size);

    filament::Engine& engine_;
    TexturePool textures_;
    std::map<std::string, filament::Material*> loaded_;
};

/// Sets one parameter; throws an Error if the material has none of this name.
template <class Value> void setParameter(filament::MaterialInstance& instance, const char* name, Value value);

} // namespace filasofia::visual
