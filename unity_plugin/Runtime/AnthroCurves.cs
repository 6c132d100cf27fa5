using System;
using System.Collections.Generic;
using UnityEngine;

namespace Anthronet
{
    /// <summary>A clip of ours as Unity's curves.</summary>
    internal static class AnthroCurves
    {
        /// <summary>One number of one joint over time.</summary>
        public struct Curve
        {
            /// <summary>The joint, below the character's object.</summary>
            public string path;
            /// <summary>Such as `localRotation.x`.</summary>
            public string property;
            public AnimationCurve keys;
        }

        static readonly string[] rotation =
            { "localRotation.x", "localRotation.y", "localRotation.z", "localRotation.w" };
        static readonly string[] position = { "localPosition.x", "localPosition.y", "localPosition.z" };

        /// <summary>Joints whose place is always told: the root and the pelvis, by which a body moves.</summary>
        const int Movers = 2;

        /// <summary>How far a joint is from where it rests before its place is told, metres.</summary>
        const float Moved = 1e-6f;

        /// <summary>An animation clip with the name and frame rate of a clip, without curves.</summary>
        public static AnimationClip NewClip(AnthroClip clip, bool legacy)
        {
            var made = new AnimationClip();
            made.name = clip.Name;
            made.legacy = legacy;
            made.frameRate = (float)clip.FramesPerSecond;
            return made;
        }

        /// <summary>All curves of a clip, joint by joint.</summary>
        public static List<Curve> Of(AnthroClip clip, AnthroRig rig)
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
                var moves = Positions(frames, joint, count, rig.Joints[joint].local.translation, numbers);
                if (moves || joint < Movers)
                {
                    Add(curves, path, position, numbers, clip);
                }
            }
            return curves;
        }

        /// <summary>The rotations of a joint. q and −q are one rotation, but not to curves: each has the sign that is next
        /// to the one before.</summary>
        static void Rotations(AnthroTransform[] frames, int joint, int stride, float[][] into)
        {
            var before = frames[joint].rotation;
            for (var frame = 0; frame < into[0].Length; frame++)
            {
                var q = frames[frame * stride + joint].rotation;
                if (Quaternion.Dot(before, q) < 0f)
                {
                    q = new Quaternion(-q.x, -q.y, -q.z, -q.w);
                }
                into[0][frame] = q.x;
                into[1][frame] = q.y;
                into[2][frame] = q.z;
                into[3][frame] = q.w;
                before = q;
            }
        }

        /// <summary>The places of a joint, and whether any is not the one where it rests.</summary>
        static bool Positions(AnthroTransform[] frames, int joint, int stride, Vector3 rest, float[][] into)
        {
            var moves = false;
            for (var frame = 0; frame < into[0].Length; frame++)
            {
                var p = frames[frame * stride + joint].translation;
                into[0][frame] = p.x;
                into[1][frame] = p.y;
                into[2][frame] = p.z;
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

        /// <summary>Keys with the slopes of straight lines from each to the next, as our own sampling goes.</summary>
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
