# Finds SOFA, whose components the room sofa then uses. This file is also installed and read by FilasofiaConfig.cmake, with
# FILASOFIA_SOFA as it was found: a static library of ours leaves linking SOFA to the program.
set(FILASOFIA_SOFA_LIBRARIES)
if(NOT FILASOFIA_SOFA STREQUAL OFF)
  set(parts Sofa.Simulation.Graph Sofa.Simulation.Common Sofa.Component.StateContainer Sofa.Component.Mass Sofa.Component.ODESolver.Backward
    Sofa.Component.ODESolver.Forward Sofa.Component.LinearSolver.Iterative Sofa.Component.LinearSolver.Direct
    Sofa.Component.Constraint.Projective Sofa.Component.SolidMechanics.FEM.Elastic
    Sofa.Component.SolidMechanics.FEM.HyperElastic Sofa.Component.SolidMechanics.Spring Sofa.Component.Topology.Container.Constant
    Sofa.Component.Topology.Container.Dynamic Sofa.Component.Mapping.Linear Sofa.Component.Mapping.NonLinear
    Sofa.Component.AnimationLoop Sofa.Component.Collision.Geometry Sofa.Component.Collision.Detection.Algorithm
    Sofa.Component.Collision.Detection.Intersection Sofa.Component.Collision.Response.Contact
    Sofa.Component.Constraint.Lagrangian.Correction Sofa.Component.Constraint.Lagrangian.Model
    Sofa.Component.Constraint.Lagrangian.Solver)
  set(missing)
  foreach(part IN LISTS parts)
    find_package(${part} QUIET)
    if(${part}_FOUND)
      list(APPEND FILASOFIA_SOFA_LIBRARIES ${part})
    else()
      list(APPEND missing ${part})
    endif()
  endforeach()
  if(NOT missing)
    # The headers are of one version; a later one renames data and moves classes.
    if(NOT Sofa.Simulation.Graph_VERSION MATCHES "^25\\.12")
      message(WARNING "The room sofa is written for SOFA 25.12, but ${Sofa.Simulation.Graph_VERSION} was found")
    endif()
    # It passes --no-undefined on to all that links it: a module of Python, which is not linked to Python, would not link.
    set_property(TARGET Sofa.Config PROPERTY INTERFACE_LINK_OPTIONS)
    set(FILASOFIA_SOFA_VERSION ${Sofa.Simulation.Graph_VERSION})
    set(FILASOFIA_HAS_SOFA ON)
  elseif(FILASOFIA_SOFA STREQUAL AUTO)
    set(FILASOFIA_SOFA_LIBRARIES)
    set(FILASOFIA_HAS_SOFA OFF)
  else()
    message(FATAL_ERROR "FILASOFIA_SOFA is ON, but find_package finds no ${missing}: add SOFA's folder to CMAKE_PREFIX_PATH "
      "(docs/guide/sofa.md)")
  endif()
else()
  set(FILASOFIA_HAS_SOFA OFF)
endif()
