#include "filasofia/visual/material_store.h"

#include "filasofia/core/error.h"
#include "filasofia/core/validate.h"

#include <cmath>

namespace filasofia::visual {
namespace {

using Kind = MaterialPackage::Kind;

Kind kindOf(const ParameterValue& value)
{
    struct Visitor {
        Kind operator()(double) const { return Kind::Float; }
        Kind operator()(int) const { return Kind::Int; }
        Kind operator()(bool) const { return Kind::Bool; }
        Kind operator()(const Color&) const { return Kind::Float3; }
        Kind operator()(const Vec3&) const { return Kind::Float3; }
        Kind operator()(const std::array<double, 4>&) const { return Kind::Float4; }
        Kind operator()(const Texture&) const { return Kind::Sampler; }
    };
    return std::visit(Visitor{}, value);
}

bool fitsFloat(const ParameterValue& value)
{
    constexpr double kLargest = 3.4e38; // a larger double is infinite as a float
    const auto fits = [](double number) { return std::abs(number) < kLargest; };
    if (const auto* number = std::get_if<double>(&value)) return fits(*number);
    if (const auto* three = std::get_if<Vec3>(&value)) return fits(three->x) && fits(three->y) && fits(three->z);
    if (const auto* four = std::get_if<std::array<double, 4>>(&value))
        return fits((*four)[0]) && fits((*four)[1]) && fits((*four)[2]) && fits((*four)[3]);
    return true;
}

/// The texture of a built-in material, of which there is at most one.
const Texture* textureOf(const Material& material)
{
    return std::visit(
        [](const auto& held) -> const Texture* {
            if constexpr (requires { held.baseColorTexture; })
                return &held.baseColorTexture;
            else if constexpr (requires { held.texture; })
                return &held.texture;
            else
                return nullptr;
        },
        material);
}

} // namespace

ReadyMaterial MaterialStore::ready(const Material& material, const std::string& object)
{
    if (const auto* named = std::get_if<NamedMaterial>(&material)) return ready(get(named->name, object), object);
    std::visit([&](const auto& held) { validate(held, object); }, material);
    if (const auto* glass = std::get_if<GlassMaterial>(&material))
        for (double share : {glass->tint.red, glass->tint.green, glass->tint.blue})
            if (share <= 0.0) fail(object, ": tint must be > 0 in every colour, got ", share);
    ReadyMaterial out;
    out.material = material;
    if (const Texture* texture = textureOf(material)) require(*texture, object, out);
    if (const auto* custom = std::get_if<CustomMaterial>(&material)) require(*custom, object, out);
    return out;
}

void MaterialStore::require(const Texture& texture, const std::string& object, ReadyMaterial& out)
{
    if (const auto* view = std::get_if<ViewPicture>(&texture)) out.views.push_back(view->view);
    if (const auto* picture = std::get_if<TextureFile>(&texture)) {
        std::shared_ptr<const Image>& kept = pictures_[picture->file];
        try {
            if (!kept) kept = std::make_shared<const Image>(loadImage(picture->file));
        } catch (const Error& error) {
            fail(object, ": ", error.what());
        }
        out.pictures[picture->file] = kept;
    }
    out.needsUv = out.needsUv || !std::holds_alternative<NoTexture>(texture);
}

void MaterialStore::require(const CustomMaterial& material, const std::string& object, ReadyMaterial& out)
{
    std::shared_ptr<const MaterialPackage>& package = packages_[material.file];
    try {
        if (!package) package = std::make_shared<const MaterialPackage>(readMaterialPackage(material.file));
    } catch (const Error& error) {
        fail(object, ": ", error.what());
    }
    out.package = package;
    for (const MaterialParameter& given : material.parameters) {
        const std::string where = text(object, ": parameter '", given.name, "' of material file '", material.file, "'");
        const MaterialPackage::Parameter* declared = package->find(given.name);
        if (!declared) fail(where, ": the file has no parameter of this name");
        if (declared->kind != kindOf(given.value))
            fail(where, ": must be a ", nameOf(declared->kind), ", got a ", nameOf(kindOf(given.value)));
        if (!fitsFloat(given.value)) fail(where, ": must be finite");
        if (const auto* texture = std::get_if<Texture>(&given.value)) require(*texture, where, out);
    }
    out.needsUv = out.needsUv || package->readsUv;
}

void MaterialStore::add(const std::string& name, const Material& material)
{
    if (name.empty()) fail("a material of the pool must have a name");
    if (!named_.emplace(name, material).second) fail("material '", name, "' already exists");
}

const Material& MaterialStore::get(const std::string& name, const std::string& object) const
{
    const auto found = named_.find(name);
    if (found == named_.end()) fail(object, ": there is no material '", name, "' in the pool");
    return found->second;
}

} // namespace filasofia::visual
