#pragma once

#include "filasofia/math/pose.h"

#include <memory>
#include <string>
#include <vector>

namespace filasofia::visual {

/// A named place in the scene, alone or relative to a parent. Entities of a VisualServer are Transforms; main thread
/// only.
class Transform {
public:
    explicit Transform(std::string name);
    /// Children keep their world pose and lose their parent.
    virtual ~Transform();
    Transform(const Transform&) = delete;
    Transform& operator=(const Transform&) = delete;

    [[nodiscard]] const std::string& name() const { return name_; }

    /// Relative to the parent, or to the world if there is none.
    [[nodiscard]] const Pose& pose() const { return pose_; }
    /// Throws an Error naming the entity unless the pose is finite and its quaternion has unit length (to 1e-6).
    void setPose(const Pose& pose);

    [[nodiscard]] Pose worldPose() const;

    /// Factor on the size of a drawn body, and on sizes and distances of its children.
    [[nodiscard]] double scale() const { return scale_; }
    /// Throws an Error naming the entity unless the scale is in (0, 1e6].
    void setScale(double scale);
    /// The product with the scales of all ancestors.
    [[nodiscard]] double worldScale() const;

    [[nodiscard]] bool visible() const { return visible_; }
    /// A hidden transform hides its children. A hidden light does not shine; a hidden camera still sees.
    void setVisible(bool visible) { visible_ = visible; }
    /// Whether it and all its ancestors are visible.
    [[nodiscard]] bool worldVisible() const;

    [[nodiscard]] Transform* parent() const { return parent_; }
    [[nodiscard]] const std::vector<Transform*>& children() const { return children_; }
    /// From now on pose() is relative to `parent`: its value stays, the place in the world changes. Detaches from a
    /// former parent. Throws an Error if this is `parent` or an ancestor of it.
    void attachTo(Transform& parent);
    /// Leaves the parent, if any, and keeps its place and size in the world.
    void detach();

    /// Expires when the transform is destroyed; for code that keeps a pointer to it.
    [[nodiscard]] std::weak_ptr<const void> life() const { return life_; }

private:
    void leaveParent();

    std::string name_;
    Pose pose_;
    double scale_ = 1.0;
    bool visible_ = true;
    Transform* parent_ = nullptr;
    std::vector<Transform*> children_;
    std::shared_ptr<const void> life_ = std::make_shared<char>();
};

/// The pose at `eye` whose -Z axis points at `target` and whose +Y axis is as near to `up` as possible: cameras and
/// lights look along -Z. If `up` is parallel to the view, another direction is chosen. Throws an Error if eye and
/// target coincide.
Pose lookAt(Vec3 eye, Vec3 target, Vec3 up = {0.0, 1.0, 0.0});

} // namespace filasofia::visual
