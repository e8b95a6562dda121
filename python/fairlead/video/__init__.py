# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""PyAV behind one door: the only package that imports av, and only when something of it is called."""

from fairlead.video.reader import Picture, count_pictures, open_video, pictures, video_size
from fairlead.video.writer import VideoWriter

__all__ = ["Picture", "VideoWriter", "count_pictures", "open_video", "pictures", "video_size"]
