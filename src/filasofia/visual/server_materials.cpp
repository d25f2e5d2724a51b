// The pool of materials of a VisualServer.
#include "filasofia/core/error.h"
#include "filasofia/visual/scene.h"

namespace filasofia::visual {
namespace {

std::string objectName(const std::string& name) { return text("material '", name, "'"); }

bool uses(const VisualBody& body, const std::string& name)
{
    const auto* named = std::get_if<NamedMaterial>(&body.material());
    return named && named->name == name;
}

void checkNotNamed(const std::string& name, const Material& material)
{
    if (std::holds_alternative<NamedMaterial>(material))
        fail(objectName(name), ": must not itself be the name of a material");
}

} // namespace

void addMaterial(Scene& scene, const std::string& name, const Material& material)
{
    checkNotNamed(name, material);
    (void)scene.materials.ready(material, objectName(name));
    scene.materials.add(name, material);
}

void changeMaterial(Scene& scene, const std::string& name, const Material& material)
{
    (void)scene.materials.get(name, objectName(name));
    checkNotNamed(name, material);
    // All errors are found before anything changes.
    std::vector<VisualBody*> users;
    for (VisualBody* body : scene.bodies)
        if (uses(*body, name)) users.push_back(body);
    const ReadyMaterial ready = scene.materials.ready(material, objectName(name));
    for (VisualBody* body : users) (void)readyMaterial(scene, material, body->impl().def.mesh, body->name());
    scene.materials.change(name, material);
    for (VisualBody* body : users) scene.backend->setMaterial(body->impl().slot, ready);
}

void removeMaterial(Scene& scene, const std::string& name)
{
    (void)scene.materials.get(name, objectName(name));
    for (const VisualBody* body : scene.bodies)
        if (uses(*body, name)) fail(objectName(name), " cannot be removed: body '", body->name(), "' uses it");
    scene.materials.remove(name);
}

} // namespace filasofia::visual
