using System;
using System.Collections.Generic;
using UnityEngine;

namespace Anthronet
{
    /// <summary>Converts AnthroNet clips to Unity's animation curves.</summary>
    internal static class AnthroCurves
    {
        /// <summary>One scalar property of one joint over time.</summary>
        public struct Curve
        {
            /// <summary>Transform path of the joint below the character.</summary>
            public string path;
            /// <summary>Such as `localRotation.x`.</summary>
            public string property;
            public AnimationCurve keys;
        }

        static readonly string[] rotation =
            { "localRotation.x", "localRotation.y", "localRotation.z", "localRotation.w" };
        static readonly string[] position = { "localPosition.x", "localPosition.y", "localPosition.z" };

        /// <summary>Number of joints that always get position curves: the root and the pelvis, which carry root
        /// motion.</summary>
        const int Movers = 2;

        /// <summary>Distance from the rest position above which a joint gets position curves, metres.</summary>
        const float Moved = 1e-6f;

        /// <summary>An animation clip with the name and frame rate of an AnthroNet clip, without curves.</summary>
        public static AnimationClip NewClip(AnthroClip clip, bool legacy)
        {
            var made = new AnimationClip();
            made.name = clip.Name;
            made.legacy = legacy;
            made.frameRate = (float)clip.FramesPerSecond;
            return made;
        }

        /// <summary>All curves of a clip, joint by joint.</summary>
        public static List<Curve> FromClip(AnthroClip clip, AnthroRig rig)
        {
            Native.Library.NotNull(rig, "rig");
            var count = clip.JointCount;
            if (rig.Bones.Length != count)
            {
                throw new ArgumentException("expected " + count + " joints, got " + rig.Bones.Length, "rig");
            }
            var frames = clip.Bake();
            var curves = new List<Curve>();
            var numbers = new float[4][];
            for (var i = 0; i < numbers.Length; i++)
            {
                numbers[i] = new float[clip.FrameCount];
            }
            for (var joint = 0; joint < count; joint++)
            {
                var path = rig.Path(joint);
                Rotations(frames, joint, count, numbers);
                Add(curves, path, rotation, numbers, clip);
                var moves = Positions(frames, joint, count, rig.Joints[joint].parentFromJoint.translation, numbers);
                if (moves || joint < Movers)
                {
                    Add(curves, path, position, numbers, clip);
                }
            }
            return curves;
        }

        /// <summary>Writes the rotations of a joint. q and −q are the same rotation but not the same curves: each
        /// quaternion gets the sign closest to its predecessor.</summary>
        static void Rotations(AnthroTransform[] frames, int joint, int stride, float[][] results)
        {
            var before = frames[joint].rotation;
            for (var frame = 0; frame < results[0].Length; frame++)
            {
                var q = frames[frame * stride + joint].rotation;
                if (Quaternion.Dot(before, q) < 0f)
                {
                    q = new Quaternion(-q.x, -q.y, -q.z, -q.w);
                }
                results[0][frame] = q.x;
                results[1][frame] = q.y;
                results[2][frame] = q.z;
                results[3][frame] = q.w;
                before = q;
            }
        }

        /// <summary>Writes the positions of a joint, and returns whether any of them differs from the rest
        /// position.</summary>
        static bool Positions(AnthroTransform[] frames, int joint, int stride, Vector3 rest, float[][] results)
        {
            var moves = false;
            for (var frame = 0; frame < results[0].Length; frame++)
            {
                var p = frames[frame * stride + joint].translation;
                results[0][frame] = p.x;
                results[1][frame] = p.y;
                results[2][frame] = p.z;
                moves |= (p - rest).magnitude > Moved;
            }
            return moves;
        }

        static void Add(List<Curve> curves, string path, string[] properties, float[][] numbers, AnthroClip clip)
        {
            for (var i = 0; i < properties.Length; i++)
            {
                curves.Add(new Curve
                {
                    path = path,
                    property = properties[i],
                    keys = new AnimationCurve(Keys(numbers[i], clip.FramesPerSecond)),
                });
            }
        }

        /// <summary>Keys with linear tangents, which interpolate as the library does between frames.</summary>
        static Keyframe[] Keys(float[] values, double framesPerSecond)
        {
            var keys = new Keyframe[values.Length];
            for (var i = 0; i < keys.Length; i++)
            {
                var last = i > 0 ? (float)((values[i] - values[i - 1]) * framesPerSecond) : 0f;
                var next = i + 1 < keys.Length ? (float)((values[i + 1] - values[i]) * framesPerSecond) : 0f;
                keys[i] = new Keyframe((float)(i / framesPerSecond), values[i], last, next);
            }
            return keys;
        }
    }
}
