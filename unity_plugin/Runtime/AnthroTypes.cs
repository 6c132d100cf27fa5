using System;
using System.Runtime.InteropServices;
using UnityEngine;

namespace Anthronet
{
    /// <summary>Sex of a person.</summary>
    public enum AnthroSex
    {
        /// <summary>Inferred from the measures.</summary>
        Any = 0,
        /// <summary>Female.</summary>
        Female = 1,
        /// <summary>Male.</summary>
        Male = 2,
    }

    /// <summary>How measures that a request does not set are filled in.</summary>
    public enum AnthroFill
    {
        /// <summary>With the most likely values, given the measures that are set.</summary>
        Mean = 0,
        /// <summary>With random plausible values, chosen by the seed.</summary>
        Sample = 1,
    }

    /// <summary>What a clip does outside its duration.</summary>
    public enum AnthroWrap
    {
        /// <summary>Plays once: holds the first or last frame.</summary>
        Once = 0,
        /// <summary>Loops; every cycle starts where the first one did.</summary>
        Loop = 1,
        /// <summary>Loops; root motion accumulates from cycle to cycle.</summary>
        RootMotion = 2,
    }

    /// <summary>Finger motion of a retargeted clip.</summary>
    public enum AnthroFingers
    {
        /// <summary>From the file if it has finger motion, otherwise relaxed.</summary>
        Source = 0,
        /// <summary>Relaxed hands.</summary>
        Relaxed = 1,
        /// <summary>As in the bind pose.</summary>
        Rest = 2,
    }

    /// <summary>The axis of a motion file that points up.</summary>
    public enum AnthroUpAxis
    {
        /// <summary>As the file says, or else found from its skeleton.</summary>
        Found = 0,
        /// <summary>+Y.</summary>
        Y = 1,
        /// <summary>+Z.</summary>
        Z = 2,
        /// <summary>+X.</summary>
        X = 3,
        /// <summary>−X.</summary>
        NegativeX = 4,
        /// <summary>−Y, as in the axes of cameras.</summary>
        NegativeY = 5,
        /// <summary>−Z.</summary>
        NegativeZ = 6,
    }

    /// <summary>Methods of skinning on the CPU.</summary>
    public enum AnthroSkinMethod
    {
        /// <summary>Linear blend skinning, Unity's method.</summary>
        Linear = 0,
        /// <summary>Dual quaternion skinning.</summary>
        DualQuaternion = 1,
        /// <summary>Joints translate vertices but do not rotate them.</summary>
        JointTranslation = 2,
    }

    /// <summary>A rotation followed by a translation, in Unity's space. Has the memory layout of the native
    /// structure.</summary>
    [Serializable]
    [StructLayout(LayoutKind.Sequential)]
    public struct AnthroTransform
    {
        /// <summary>The rotation.</summary>
        public Quaternion rotation;
        /// <summary>The translation, metres.</summary>
        public Vector3 translation;
    }

    /// <summary>A joint in the bind pose, in Unity's space. Has the memory layout of the native structure.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct AnthroJoint
    {
        /// <summary>Index of the parent, which precedes this joint; −1 for the root.</summary>
        public int parent;
        /// <summary>Length of the bone, from the joint along its +Y axis, metres.</summary>
        public float length;
        /// <summary>Transform relative to the parent.</summary>
        public AnthroTransform parentFromJoint;
        /// <summary>Matrix from the joint's space to the character's.</summary>
        public Matrix4x4 modelFromJoint;
        /// <summary>Unity's bind pose: matrix from the character's space to the joint's.</summary>
        public Matrix4x4 jointFromModel;
    }

    /// <summary>Report of one measure of a body, metres. Has the memory layout of the native structure.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct AnthroMeasureReport
    {
        /// <summary>The requested value; 0 if the request does not set the measure.</summary>
        public double asked;
        /// <summary>The value of the body.</summary>
        public double obtained;
        /// <summary>Obtained minus asked; 0 if the request does not set the measure.</summary>
        public double residual;
        /// <summary>Lower bound of the interval that contains 90 % of the people with the requested measures.</summary>
        public double low90;
        /// <summary>Upper bound of that interval.</summary>
        public double high90;
        /// <summary>Percentage of people of this sex whose value is not above the obtained one, 0 to 100.</summary>
        public double percentile;
        uint given;
        uint filled;

        /// <summary>Whether the request sets the measure.</summary>
        public bool Given
        {
            get { return given != 0; }
        }

        /// <summary>How the measure was filled in if the request does not set it.</summary>
        public AnthroFill Filled
        {
            get { return (AnthroFill)filled; }
        }
    }
}
