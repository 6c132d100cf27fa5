using System;
using System.Collections.Generic;

namespace Anthronet
{
    /// <summary>The measures, by name, in the order of the native library. Available without loading the
    /// library.</summary>
    public static class AnthroMeasures
    {
        /// <summary>Number of measures.</summary>
        public const int Count = 36;

        static readonly string[] all =
        {
            "waist_circumference", "chest_circumference", "hip_circumference", "height", "shoulder_width",
            "torso_height_back", "torso_height_front", "head_circumference", "neck_circumference", "head_height",
            "neck_length_midline", "neck_length_lateral",
            "hand_size_left", "arm_circumference_left", "arm_length_left", "forearm_circumference_left",
            "forearm_length_left", "thigh_circumference_left", "thigh_length_left", "calf_circumference_left",
            "calf_length_left", "foot_width_left", "heel_to_ball_length_left", "heel_to_toe_length_left",
            "hand_size_right", "arm_circumference_right", "arm_length_right", "forearm_circumference_right",
            "forearm_length_right", "thigh_circumference_right", "thigh_length_right", "calf_circumference_right",
            "calf_length_right", "foot_width_right", "heel_to_ball_length_right", "heel_to_toe_length_right",
        };

        /// <summary>Number of measures without a side, such as `height`. They come first, then those of the left side, then
        /// the same of the right side.</summary>
        internal static readonly int Central = Array.FindIndex(all, name => name.EndsWith("_left", StringComparison.Ordinal));

        /// <summary>Number of measures of each side.</summary>
        internal static readonly int PerSide = (Count - Central) / 2;

        /// <summary>Names of the measures.</summary>
        public static readonly IReadOnlyList<string> Names = Array.AsReadOnly(all);

        /// <summary>The index of a measure; −1 if there is no measure of this name.</summary>
        public static int IndexOf(string name)
        {
            return Array.IndexOf(all, name);
        }

        /// <summary>The indices that a name stands for: one, or those of both sides if the name has no side.</summary>
        /// <exception cref="AnthroException">There is no measure of this name.</exception>
        public static void IndicesOf(string name, out int first, out int second)
        {
            first = IndexOf(name);
            second = first;
            if (first < 0)
            {
                first = IndexOf(name + "_left");
                second = IndexOf(name + "_right");
            }
            if (first < 0)
            {
                throw new AnthroException(
                    AnthroError.Request, "there is no measure \"" + name + "\"; AnthroMeasures.Names lists them");
            }
        }
    }
}
