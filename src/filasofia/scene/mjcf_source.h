#pragma once

#include "filasofia/scene/rigid_tree.h"

#include <map>
#include <set>

/// A model of MuJoCo as elements whose attributes know their defaults.
namespace filasofia::scene {

/// <compiler>: how numbers are meant, and where files are.
struct MjcfCompiler {
    bool degrees = true;
    std::string eulerOrder = "xyz";
    std::filesystem::path meshFolder = {};
    bool autoLimits = true;
    enum class FromGeoms { Never, Always, IfMissing } fromGeoms = FromGeoms::IfMissing;
};

/// The files of a model, with what their elements refer to.
class MjcfSource {
public:
    MjcfSource(const std::filesystem::path& file, const ImportOptions& options);

    [[nodiscard]] Element root() const { return root_; }
    /// The elements in another, those of included files in their places.
    [[nodiscard]] std::vector<Element> childrenOf(const Element& of) const;
    /// All elements of this tag that stand directly in <mujoco>.
    [[nodiscard]] std::vector<Element> sections(std::string_view tag) const;

    /// An element's attributes with its class behind them, or with `childClass` if it has none; tells what is not read.
    [[nodiscard]] Attributes attributesOf(const Element& element, const std::string& childClass);
    /// The class of the elements in a body or frame.
    [[nodiscard]] std::string childClassOf(const Element& element, const std::string& outer) const;

    /// Throws an Error if an element gives it in two ways.
    [[nodiscard]] Quat orientationOf(const Attributes& says) const;
    [[nodiscard]] Pose poseOf(const Attributes& says) const;
    [[nodiscard]] double angle(double value) const; ///< [rad]
    /// The surface of a mesh of the assets.
    [[nodiscard]] std::shared_ptr<const geometry::TriangleMesh> meshOf(const Attribute& name);
    /// What an element looks like: its rgba, or its material; nothing if it says neither.
    struct Look {
        std::optional<visual::Material> material = {};
        bool hidden = false; ///< it is transparent
    };
    [[nodiscard]] Look lookOf(const Attributes& says);

    XmlReader reader;
    MjcfCompiler compiler;

private:
    struct Class {
        std::string parent;
        std::map<std::string, std::vector<Element>, std::less<>> elements = {}; ///< by their tags
    };
    void include(const XmlFile& file);
    void readCompiler(const Element& element);
    void readClass(const Element& element, const std::string& parent, int depth);
    void readAssets(const Element& assets);
    [[nodiscard]] const Class& classNamed(const Attribute& name) const;
    /// A mesh that the file itself has, by its vertices and perhaps its faces.
    [[nodiscard]] geometry::TriangleMesh givenMesh(const Attributes& says) const;
    [[nodiscard]] Quat turnOf(const Attribute& found) const;
    [[nodiscard]] Quat eulerOf(const std::vector<double>& angles) const;

    Element root_;
    std::map<pugi::xml_node, const XmlFile*> includes_; ///< what <include> elements stand for
    std::set<std::filesystem::path> included_;
    std::map<std::string, Class, std::less<>> classes_;
    std::map<std::string, Element, std::less<>> meshAssets_, materials_;
    std::map<std::string, std::shared_ptr<const geometry::TriangleMesh>, std::less<>> meshes_;
};

/// The shortest turn from z to this direction, which has length 1.
Quat turnOfZ(Vec3 direction);

/// The attributes that are read of the elements that have defaults; null for other tags.
const std::vector<std::string_view>* carriedAttributes(std::string_view tag);

} // namespace filasofia::scene
