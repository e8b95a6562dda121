# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""What the publication reports, as far as its figures are known to us. Nothing here was measured by us.

Source: Guo, Chen, Wang, Zhang, Sun 2024, Joint Optimization of the 3D Model and 6D Pose for Monocular Pose Estimation,
Drones 8(11), 626, doi 10.3390/drones8110626. Times are on the authors' hardware.
"""

SOURCE = "Guo et al. 2024, doi 10.3390/drones8110626"
THEIRS = "published, their hardware"

TINYPOSE_EPNP_MS = 8.15
"""Table 5: PP-TinyPose-EPnP per frame."""
RTMPOSE_EPNP_MS = 29.15
"""Table 9: RTMPose-EPnP per frame, real sequences."""
METHOD_MS = 32.5
"""Table 5: the whole method per frame, synthetic sequences."""
METHOD_REAL_MS = 36.15
"""Table 9: the whole method per frame, real sequences."""

REAL_ORBIT_MODEL_GAIN = 0.04
REAL_RENDEZVOUS_MODEL_GAIN = 0.10
"""Share by which the mean error of the model fell in the real sequences."""

NOISE_BREAK_PX = 2.0
"""Figure 7: the model improves below this noise."""

FIGURE_7 = (
    "Works while the noise of the landmarks is below 2 px; beyond, the model is no longer improved and the pose is as "
    "bad as EPnP's or worse."
)
FIGURE_8 = (
    "Some gain at every rendezvous angle; of no practical value at 5 degrees, large above 30 degrees. The noise of the "
    "sweep is not published."
)
SEQUENCES = (
    "The published method is the best of three on all four sequences; Orbit-2.0 improves least, because range "
    "magnifies the error of the landmarks; small angles still work because the range closes. The values of tables 2 to "
    "4 are not at hand, so that only these findings stand beside ours."
)
REAL = (
    "On a hand-held orbit and a hand-held rendezvous of a real ship the error of the model falls by about 4 % and 10 "
    "%; single landmarks get worse, and on some frames plain EPnP wins. Truth poses were annotated by hand."
)
FAILURES = "Large errors of the landmarks make pose and model worse (figures 17 and 18 show single frames)."
WEATHER = "Nothing was tried in bad weather; planned: training images with glare, rain, snow and fog."
RANGE = "Planned: fusing infrared or LiDAR."
