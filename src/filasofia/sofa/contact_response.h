#pragma once

#include "filasofia/sofa/collision_models.h"
#include "filasofia/sofa/sofa_vec.h"

#include "filasofia/frame/contact.h"

#include <span>
#include <vector>

namespace filasofia::sofaengine {

/// A contact, and the elements of its bodies if these are rigid.
struct FoundContact {
    frame::Contact contact = {};
    int firstElement = 0;
    int secondElement = 0;
};

/// What SOFA's contact manager makes for two models that touch, as it tells us of its contacts.
class ContactSource {
public:
    virtual ~ContactSource() = default;
    /// Adds its contacts of the last step. `impulses`: those by all constraints [N s]; dt [s].
    virtual void read(std::span<const double> impulses, double dt, std::vector<FoundContact>& out) const = 0;

    ContactSource() = default;
    ContactSource(const ContactSource&) = delete;
    ContactSource& operator=(const ContactSource&) = delete;
};

inline constexpr const char* kFriction = "FilasofiaFriction"; ///< the response's name: Coulomb friction
inline constexpr const char* kPenalty = "FilasofiaPenalty";   ///< a spring per contact, without friction

/// Makes both known to SOFA, once per process.
void registerResponses();

} // namespace filasofia::sofaengine
