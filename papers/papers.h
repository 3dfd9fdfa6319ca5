#pragma once

// The published studies that abbe-papers recomputes, one folder each.
#include "reproduce.h"

namespace abbe {

/// The study that the options name. @returns an ExitCode
int reproduce_paper(const ReproduceOptions& options);

/// Wang et al. (2020): integrated error of the measured grinder. @returns an ExitCode
int reproduce_wang(const ReproduceOptions& options);
/// Aguado et al. (2014): laser tracker on an XCFZ machine. @returns an ExitCode
int reproduce_aguado(const ReproduceOptions& options);
/// Yin et al. (2021): laser engraver, linkage, workpiece, contour error. @returns an ExitCode
int reproduce_yin(const ReproduceOptions& options);
/// Liu et al. (2021): cradle-type five-axis scanner, virtual measurement of its parts. @returns an ExitCode
int reproduce_liu(const ReproduceOptions& options);
/// Ma et al. (2021): polygon prism on a rotary table. @returns an ExitCode
int reproduce_ma(const ReproduceOptions& options);

}  // namespace abbe
