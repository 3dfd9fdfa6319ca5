#pragma once

#include <string>

#include "abbe/study/evaluations/evaluation.h"

namespace abbe {

// Evaluations of the tests of a request, before tolerances are applied. @param file  of the readings

Evaluation evaluated(const PositioningTest& test, const std::string& file);
Evaluation evaluated(const DiagonalsTest& test, const std::string& file);
Evaluation evaluated(const CircularTest& test, const std::string& file);
Evaluation evaluated(const RotationTest& test, const std::string& file);
Evaluation evaluated(const StraightnessTest& test, const std::string& file);
Evaluation evaluated(const SquarenessTest& test, const std::string& file);
Evaluation evaluated(const SectionsTest& test, const std::string& file);
Evaluation evaluated(const ContourPointsTest& test, const std::string& file);
Evaluation evaluated(const LinkageTest& test, const std::string& file);
Evaluation evaluated(const EtveTest& test, const std::string& file);
Evaluation evaluated(const SpindleDistortionTest& test, const std::string& file);
Evaluation evaluated(const AxisDistortionTest& test, const std::string& file);
Evaluation evaluated(const LocationDistortionTest& test, const std::string& file);

/// @throws InputError if there are none
void require_readings(bool there_are, const std::string& file);

}  // namespace abbe
