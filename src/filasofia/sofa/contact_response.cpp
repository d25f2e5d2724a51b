#include "filasofia/sofa/contact_response.h"

#include <sofa/component/collision/geometry/LineCollisionModel.h>
#include <sofa/component/collision/geometry/PointCollisionModel.h>
#include <sofa/component/collision/geometry/TriangleCollisionModel.h>
#include <sofa/component/collision/response/contact/BarycentricPenalityContact.h>
#include <sofa/component/collision/response/contact/FrictionContact.h>
#include <sofa/component/collision/response/contact/PenalityContactForceField.h>
#include <sofa/component/constraint/lagrangian/model/UnilateralLagrangianConstraint.h>

#include <cmath>

namespace filasofia::sofaengine {
namespace {

namespace models = ::sofa::component::collision::geometry;
namespace response = ::sofa::component::collision::response::contact;
namespace model = ::sofa::component::constraint::lagrangian::model;
using ::sofa::core::behavior::ConstraintResolution;
using ::sofa::core::objectmodel::New;
using Points = models::PointCollisionModel<Vec3Types>;
using Lines = models::LineCollisionModel<Vec3Types>;
using Triangles = models::TriangleCollisionModel<Vec3Types>;

constexpr double kParting = 0.01; // [m/s] by which surfaces that overlap part, apart from what else moves them

/// SOFA divides by how far an impulse moves the two points: nothing may be done where both are held, as at pins.
class FrictionResolution final : public model::UnilateralConstraintResolutionWithFriction {
public:
    using UnilateralConstraintResolutionWithFriction::UnilateralConstraintResolutionWithFriction;
    void resolution(int line, SReal** w, SReal* d, SReal* force, SReal* free) override
    {
        if (_W[0] > 0.0 && _W[3] + _W[5] > 0.0)
            UnilateralConstraintResolutionWithFriction::resolution(line, w, d, force, free);
    }
};
class NormalResolution final : public model::UnilateralConstraintResolution {
public:
    void resolution(int line, SReal** w, SReal* d, SReal* force, SReal* free) override
    {
        if (w[line][line] > 0.0) UnilateralConstraintResolution::resolution(line, w, d, force, free);
    }
};

/// SOFA's constraints of two models in contact, with their numbers.
class ContactRows final : public model::UnilateralLagrangianConstraint<Vec3Types> {
public:
    SOFA_CLASS(ContactRows, SOFA_TEMPLATE(model::UnilateralLagrangianConstraint, Vec3Types));
    ContactRows(MechanicalState* first, MechanicalState* second) : UnilateralLagrangianConstraint(first, second) {}
    std::array<ModelTag, 2> tags = {}; ///< the models in contact

    [[nodiscard]] const auto& rows() const { return contacts; }
    /// SOFA parts what overlaps at once, which throws bodies that were placed within their skins. Bodies that are
    /// welded together are not parted: weld and contact would work against each other.
    void getPositionViolation(::sofa::linearalgebra::BaseVector* out) override
    {
        UnilateralLagrangianConstraint::getPositionViolation(out);
        const double way = weldOf(tags[0], tags[1]) ? 0.0 : kParting * this->getContext()->getDt();
        for (const Contact& each : contacts) {
            const double gap = dot(each.P - each.Q, each.norm) - each.contactDistance;
            if (gap + way < 0.0) out->add(each.id, -(gap + way)); // as if the surfaces were that much farther in
        }
    }
    void getConstraintResolution(const ::sofa::core::ConstraintParams* /*params*/,
                                 std::vector<ConstraintResolution*>& all, unsigned int& offset) override
    {
        for (const Contact& contact : contacts) {
            const bool rough = contact.parameters.hasTangentialComponent();
            all[offset] = rough ? static_cast<ConstraintResolution*>(new FrictionResolution(contact.parameters.mu))
                                : new NormalResolution; // SOFA deletes them
            offset += rough ? 3 : 1;
        }
    }
};

const ModelTag& tagOf(const ::sofa::core::CollisionModel* each) { return dynamic_cast<const Tagged&>(*each).tag; }

/// [-] As the native engine: the square root of the product.
double frictionOf(const ModelTag& a, const ModelTag& b) { return std::sqrt(a.friction * b.friction); }

/// In our order: the first body is the one with the smaller id. `normal` leads from a to b, `force` [N] is on b.
FoundContact contactOf(const ModelTag& a, const ModelTag& b, Vec3 normal, Vec3 force)
{
    const bool turned = a.body < b.body;
    const double pressed = dot(force, normal);
    const Vec3 across = force - pressed * normal;
    const double sign = turned ? -1.0 : 1.0;
    return {.contact = {.first = turned ? a.body : b.body,
                        .second = turned ? b.body : a.body,
                        .normal = sign * normal,
                        .normalForce = pressed,
                        .friction = sign * across},
            .firstElement = turned ? a.element : b.element,
            .secondElement = turned ? b.element : a.element};
}

/// In SOFA 25.12 the mapping of a contact and its mapper hold each other, and with them the surface, when the contact
/// has long ended: the mapper needs no master.
template <class Mapper> void freeMapper(Mapper& contact)
{
    if constexpr (requires { contact.mapping->removeSlave(contact.mapper); })
        if (contact.mapping && contact.mapper) contact.mapping->removeSlave(contact.mapper);
}

template <class First, class Second> class Friction final : public response::FrictionContact<First, Second>,
                                                            public ContactSource {
public:
    using Base = response::FrictionContact<First, Second>;
    using Base::Base;
    SOFA_CLASS(SOFA_TEMPLATE2(Friction, First, Second), Base);

    [[nodiscard]] model::UnilateralLagrangianContactParameters getParameterFromDatas() const override
    {
        return {frictionOf(tagOf(this->model1), tagOf(this->model2))};
    }
    /// What a weld holds has no contact, which would hold the same. Surfaces that touch exactly have no distance to
    /// point along: faces have their normal, and others no contact there.
    void setDetectionOutputs(::sofa::core::collision::DetectionOutputVector* outputs) override
    {
        Base::setDetectionOutputs(outputs);
        const auto points = [](const auto* each) { return std::abs(each->normal.norm2() - 1.0) < 1e-3; }; // no NaN does
        for (auto* each : this->contacts) {
            if (points(each)) continue;
            if constexpr (std::is_same_v<First, Triangles>)
                each->normal = typename First::Element(each->elem.first).n();
        }
        const geometry::Box* weld = weldOf(tagOf(this->model1), tagOf(this->model2));
        const auto isHeld = [&](const auto* each) {
            return weld && geometry::squaredDistance(*weld, fromSofa(each->point[0])) == 0.0;
        };
        std::erase_if(this->contacts, [&](const auto* each) { return !points(each) || isHeld(each); });
    }
    void setupConstraint(typename Base::MechanicalState1* first, typename Base::MechanicalState2* second) override
    {
        const auto rows = New<ContactRows>(first, second);
        rows->tags = {tagOf(this->model1), tagOf(this->model2)};
        this->m_constraint = rows;
        freeMapper(this->mapper1); // both have just been made
        freeMapper(this->mapper2);
    }
    void read(std::span<const double> impulses, double dt, std::vector<FoundContact>& out) const override
    {
        const auto* rows = dynamic_cast<const ContactRows*>(this->m_constraint.get());
        if (!rows) return;
        for (const auto& row : rows->rows()) {
            const bool rough = row.parameters.hasTangentialComponent();
            if (row.id + (rough ? 3 : 1) > impulses.size()) continue;
            Vec3 impulse = impulses[row.id] * fromSofa(row.norm);
            if (rough) impulse += impulses[row.id + 1] * fromSofa(row.t) + impulses[row.id + 2] * fromSofa(row.s);
            out.push_back(contactOf(tagOf(this->model1), tagOf(this->model2), fromSofa(row.norm), impulse / dt));
            out.back().contact.point = 0.5 * (fromSofa(row.P) + fromSofa(row.Q));
            out.back().contact.gap = dot(fromSofa(row.P) - fromSofa(row.Q), fromSofa(row.norm)) - row.contactDistance;
        }
    }
};

template <class First, class Second> class Penalty final : public response::BarycentricPenalityContact<First, Second>,
                                                           public ContactSource {
public:
    using Base = response::BarycentricPenalityContact<First, Second>;
    SOFA_CLASS(SOFA_TEMPLATE2(Penalty, First, Second), Base);
    Penalty(First* first, Second* second, ::sofa::core::collision::Intersection* method) : Base(first, second, method)
    {
    }

    void setDetectionOutputs(::sofa::core::collision::DetectionOutputVector* outputs) override
    {
        Base::setDetectionOutputs(outputs);
        freeMapper(this->mapper1);
        freeMapper(this->mapper2);
        auto& contacts = *this->ff->contacts.beginEdit();
        for (auto& each : contacts) each.ks = tagOf(this->model1).stiffness; // SOFA's is divided by the distance
        this->ff->contacts.endEdit();
    }
    void read(std::span<const double> /*impulses*/, double /*dt*/, std::vector<FoundContact>& out) const override
    {
        if (!this->ff) return;
        const auto x1 = this->ff->getMState1()->readPositions(), x2 = this->ff->getMState2()->readPositions();
        for (const auto& each : this->ff->getContact()) {
            const Vec3 normal = fromSofa(each.norm);
            const double force = each.pen > 0.0 ? each.ks * each.pen : 0.0;
            out.push_back(contactOf(tagOf(this->model1), tagOf(this->model2), normal, force * normal));
            out.back().contact.point = 0.5 * (fromSofa(x1[each.m1]) + fromSofa(x2[each.m2]));
            out.back().contact.gap = -each.pen;
        }
    }
};

template <template <class, class> class Response> void registerPairs(const char* name)
{
    using Factory = ::sofa::core::collision::Contact::Factory;
    using ::sofa::helper::Creator;
    static const Creator<Factory, Response<Triangles, Points>> faces(name, true);
    static const Creator<Factory, Response<Lines, Lines>> edges(name, true);
    static const Creator<Factory, Response<Lines, Points>> corners(name, true);
    static const Creator<Factory, Response<Points, Points>> vertices(name, true);
}

} // namespace

void registerResponses()
{
    registerPairs<Friction>(kFriction);
    registerPairs<Penalty>(kPenalty);
}

} // namespace filasofia::sofaengine
