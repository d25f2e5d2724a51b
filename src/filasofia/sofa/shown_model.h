#pragma once

#include "filasofia/sofa/sofa_vec.h"

#include <sofa/core/State.h>
#include <sofa/core/objectmodel/DataFileName.h>
#include <sofa/core/topology/BaseMeshTopology.h>

namespace filasofia::sofaengine {

/// Stands for SOFA's OglModel where no plugin for OpenGL is loaded: the vertices that mappings move, and the faces over
/// them. Our own renderer draws them.
class ShownModel final : public ::sofa::core::State<Vec3Types> {
public:
    SOFA_CLASS(ShownModel, SOFA_TEMPLATE(::sofa::core::State, Vec3Types));
    using Topology = ::sofa::core::topology::BaseMeshTopology;
    using Coords = ::sofa::Data<VecCoord>;
    using Derivs = ::sofa::Data<VecDeriv>;
    using Rows = ::sofa::Data<MatrixDeriv>;
    ShownModel();

    Coords d_position; ///< [m]
    ::sofa::Data<Topology::SeqTriangles> d_triangles;
    ::sofa::Data<Topology::SeqQuads> d_quads;
    ::sofa::core::objectmodel::DataFileName d_file; ///< a mesh of its own
    /// How its own vertices are placed at the start: scaled, turned about x, y and z, moved.
    ::sofa::Data<::sofa::type::Vec3> d_scale3d, d_rotation, d_translation; ///< [-] [deg] and the scene's unit
    ::sofa::Data<double> d_scale, d_dx, d_dy, d_dz;                        ///< older names of these

    void parse(::sofa::core::objectmodel::BaseObjectDescription* words) override;
    void init() override;
    /// The mesh whose faces it shows; null if it has faces of its own.
    [[nodiscard]] Topology* mesh() const;
    bool insertInNode(::sofa::core::objectmodel::BaseNode* node) override;
    bool removeInNode(::sofa::core::objectmodel::BaseNode* node) override;
    [[nodiscard]] ::sofa::Size getSize() const override
    {
        return static_cast<::sofa::Size>(d_position.getValue().size());
    }
    void resize(::sofa::Size size) override;
    // A picture has positions and nothing else.
    Coords* write(::sofa::core::VecCoordId id) override { return id == kPlace ? &d_position : nullptr; }
    const Coords* read(::sofa::core::ConstVecCoordId /*id*/) const override { return &d_position; }
    Derivs* write(::sofa::core::VecDerivId /*id*/) override { return nullptr; }
    const Derivs* read(::sofa::core::ConstVecDerivId /*id*/) const override { return nullptr; }
    Rows* write(::sofa::core::MatrixDerivId /*id*/) override { return nullptr; }
    const Rows* read(::sofa::core::ConstMatrixDerivId /*id*/) const override { return nullptr; }
    ::sofa::core::objectmodel::BaseData* baseWrite(::sofa::core::VecId id) override
    {
        return id == ::sofa::core::VecId(kPlace) ? &d_position : nullptr;
    }
    const ::sofa::core::objectmodel::BaseData* baseRead(::sofa::core::ConstVecId id) const override
    {
        return id == ::sofa::core::ConstVecId(kPlace) ? &d_position : nullptr;
    }

private:
    void place();
    static constexpr auto kPlace = ::sofa::core::vec_id::write_access::position;
    bool showsMesh_ = false;    ///< it has no vertices of its own
    bool isNodesState_ = false; ///< the node has it as its state
};

/// Makes it known to SOFA under the name OglModel, once per process, unless SOFA has one.
void registerShownModel();

} // namespace filasofia::sofaengine
