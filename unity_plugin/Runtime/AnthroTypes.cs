using System;
using System.Runtime.InteropServices;
using UnityEngine;

namespace Anthronet
{
    /// <summary>The sex of a request.</summary>
    public enum AnthroSex
    {
        /// <summary>Left to the measures.</summary>
        Any = 0,
        /// <summary>Female.</summary>
        Female = 1,
        /// <summary>Male.</summary>
        Male = 2,
    }

    /// <summary>How open measures are filled.</summary>
    public enum AnthroFill
    {
        /// <summary>With their likeliest values beside the given ones.</summary>
        Mean = 0,
        /// <summary>With a draw from what is plausible; the seed chooses.</summary>
        Sample = 1,
    }

    /// <summary>What a clip is outside its duration.</summary>
    public enum AnthroWrap
    {
        /// <summary>It holds its first or last frame.</summary>
        Once = 0,
        /// <summary>It starts anew.</summary>
        Loop = 1,
        /// <summary>It starts anew and goes on from where the last round ended.</summary>
        Travel = 2,
    }

    /// <summary>What the fingers of a retargeted motion do.</summary>
    public enum AnthroFingers
    {
        /// <summary>As in the file where it has any, else at ease.</summary>
        Source = 0,
        /// <summary>At ease.</summary>
        Relaxed = 1,
        /// <summary>As in the bind pose.</summary>
        Rest = 2,
    }

    /// <summary>How surfaces are posed on the processor.</summary>
    public enum AnthroSkinning
    {
        /// <summary>Linear blend skinning, as Unity does it.</summary>
        Linear = 0,
        /// <summary>Dual quaternions.</summary>
        DualQuaternion = 1,
        /// <summary>Joints move vertices but do not turn them.</summary>
        JointTranslation = 2,
    }

    /// <summary>A rotation, then a translation in metres, in Unity's space. Laid out as the library's.</summary>
    [Serializable]
    [StructLayout(LayoutKind.Sequential)]
    public struct AnthroTransform
    {
        /// <summary>The rotation.</summary>
        public Quaternion rotation;
        /// <summary>Metres.</summary>
        public Vector3 translation;
    }

    /// <summary>A joint in the bind pose, in Unity's space. Laid out as the library's.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct AnthroJoint
    {
        /// <summary>Place of the parent, before this joint's own; −1 of the root.</summary>
        public int parent;
        /// <summary>From the joint along its +Y axis to where its bone ends, metres.</summary>
        public float length;
        /// <summary>Relative to the parent.</summary>
        public AnthroTransform local;
        /// <summary>From the joint's space to the character's.</summary>
        public Matrix4x4 modelFromJoint;
        /// <summary>What Unity calls the bind pose: from the character's space to the joint's.</summary>
        public Matrix4x4 jointFromModel;
    }

    /// <summary>One measure of a body, metres. Laid out as the library's.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct AnthroMeasureReport
    {
        /// <summary>What the request gives; 0 of an open measure.</summary>
        public double asked;
        /// <summary>What the body has.</summary>
        public double obtained;
        /// <summary>Obtained − asked; 0 of an open measure.</summary>
        public double residual;
        /// <summary>Lower end of what 90 % of people with the given measures have.</summary>
        public double low90;
        /// <summary>Upper end of it.</summary>
        public double high90;
        /// <summary>Share of people of this sex, 0 to 100, who have at most the obtained value.</summary>
        public double percentile;
        uint given;
        uint filled;

        /// <summary>Whether the request gives it.</summary>
        public bool Given
        {
            get { return given != 0; }
        }

        /// <summary>How it was filled where it is open.</summary>
        public AnthroFill Filled
        {
            get { return (AnthroFill)filled; }
        }
    }
}
